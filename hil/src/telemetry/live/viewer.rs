//! One viewer: handshake, subscriptions, and the messages that it subscribed to.

use std::collections::BTreeMap;
use std::io;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, TryRecvError};
use tungstenite::handshake::server::{ErrorResponse, Request as Upgrade, Response};
use tungstenite::http::{HeaderValue, StatusCode, header::SEC_WEBSOCKET_PROTOCOL};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket, accept_hdr_with_config};

use super::protocol::{Request, SUBPROTOCOLS, message, request, time};

/// How long a viewer may take to say what it wants, and to take a message.
const PATIENCE: Duration = Duration::from_secs(2);
/// How long the thread waits for a request before it looks for messages again.
const LISTEN: Duration = Duration::from_millis(5);
/// Requests are short.
const LONGEST_REQUEST: usize = 1 << 16;

/// What every viewer is told first.
pub struct Greeting {
    pub server_info: String,
    pub advertise: String,
}

/// The messages of a tick, one for each topic.
pub struct Messages {
    pub time_ns: u64,
    pub texts: Vec<Vec<u8>>,
}

/// Serves a viewer until it leaves or the run is over. Gives the number of ticks of which it was sent something.
pub fn serve(stream: TcpStream, greeting: &Greeting, waiting: &Receiver<Arc<Messages>>) -> u64 {
    let mut sent = 0;
    // Whatever a viewer does wrong, it is only its own connection that ends.
    let _ = connected(stream, greeting, waiting, &mut sent);
    sent
}

fn connected(
    stream: TcpStream,
    greeting: &Greeting,
    waiting: &Receiver<Arc<Messages>>,
    sent: &mut u64,
) -> Result<(), Error> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(LONGEST_REQUEST))
        .max_frame_size(Some(LONGEST_REQUEST));
    let mut socket =
        accept_hdr_with_config(stream, choose_subprotocol, Some(config)).map_err(|_| Error::ConnectionClosed)?;
    socket.send(Message::text(greeting.server_info.as_str()))?;
    socket.send(Message::text(greeting.advertise.as_str()))?;
    socket.get_ref().set_read_timeout(Some(LISTEN))?;
    let mut subscriptions: BTreeMap<u32, usize> = BTreeMap::new();
    loop {
        hear(&mut socket, &mut subscriptions)?;
        loop {
            match waiting.try_recv() {
                Ok(messages) => *sent += u64::from(write(&mut socket, &subscriptions, &messages)?),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return part(socket),
            }
        }
        socket.flush()?;
    }
}

/// Takes the first of our subprotocols that the viewer offers, and refuses one that offers none.
#[allow(clippy::result_large_err, reason = "the form is that of the library")]
fn choose_subprotocol(asked: &Upgrade, mut answer: Response) -> Result<Response, ErrorResponse> {
    let offered: Vec<&str> = (asked.headers().get_all(SEC_WEBSOCKET_PROTOCOL).iter())
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(',').map(str::trim))
        .collect();
    match SUBPROTOCOLS.into_iter().find(|own| offered.contains(own)) {
        Some(own) => {
            answer
                .headers_mut()
                .insert(SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(own));
            Ok(answer)
        }
        None => {
            let mut refusal = ErrorResponse::new(Some(format!("this server speaks {}\n", SUBPROTOCOLS.join(" and "))));
            *refusal.status_mut() = StatusCode::BAD_REQUEST;
            Err(refusal)
        }
    }
}

/// Takes the requests that have come.
fn hear(socket: &mut WebSocket<TcpStream>, subscriptions: &mut BTreeMap<u32, usize>) -> Result<(), Error> {
    loop {
        let text = match socket.read() {
            Ok(Message::Text(text)) => text,
            Ok(_) => continue,
            Err(Error::Io(error)) if is_only_late(&error) => return Ok(()),
            Err(error) => return Err(error),
        };
        match request(&text) {
            Some(Request::Subscribe { subscriptions: wanted }) => {
                let places = wanted
                    .iter()
                    .filter_map(|one| Some((one.id, one.channel_id.checked_sub(1)? as usize)));
                subscriptions.extend(places);
            }
            Some(Request::Unsubscribe { subscription_ids }) => {
                subscriptions.retain(|id, _| !subscription_ids.contains(id));
            }
            None => {}
        }
    }
}

fn is_only_late(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

/// Sends what the viewer has subscribed to; says whether that was anything.
fn write(
    socket: &mut WebSocket<TcpStream>,
    subscriptions: &BTreeMap<u32, usize>,
    messages: &Messages,
) -> Result<bool, Error> {
    let mut is_any = false;
    for (id, topic) in subscriptions {
        let Some(text) = messages.texts.get(*topic) else {
            continue;
        };
        if !is_any {
            socket.write(Message::binary(time(messages.time_ns)))?;
        }
        socket.write(Message::binary(message(*id, messages.time_ns, text)))?;
        is_any = true;
    }
    Ok(is_any)
}

/// Closes the connection in order, so that what was sent arrives.
fn part(mut socket: WebSocket<TcpStream>) -> Result<(), Error> {
    socket.close(None)?;
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        match socket.read() {
            Ok(_) => {}
            Err(Error::Io(error)) if is_only_late(&error) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
