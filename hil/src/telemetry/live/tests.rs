//! Viewers of all kinds: one that follows, one that is silent, one that speaks another protocol, and one that goes.

use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc;

use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

use super::super::topic::{Column, Value};
use super::server::Server;
use super::{Live, Rows, Served};
use crate::record::command_hash;
use crate::run::{both, vehicle};
use crate::scenario::{self, Scenario};

fn connect(address: SocketAddr, subprotocol: &str) -> Result<WebSocket<TcpStream>, String> {
    let mut request = format!("ws://{address}").into_client_request().expect("an address");
    let offered = HeaderValue::from_str(subprotocol).expect("a name");
    request.headers_mut().insert("Sec-WebSocket-Protocol", offered);
    let stream = TcpStream::connect(address).expect("a server");
    let (socket, answer) = tungstenite::client(request, stream).map_err(|error| error.to_string())?;
    assert_eq!(
        answer.headers()["Sec-WebSocket-Protocol"],
        subprotocol.rsplit(", ").next().expect("one")
    );
    Ok(socket)
}

fn text(socket: &mut WebSocket<TcpStream>) -> serde_json::Value {
    let message = socket.read().expect("a message");
    serde_json::from_str(message.to_text().expect("text")).expect("JSON")
}

/// Messages of the first channel until the server closes: time in nanoseconds, and text.
fn follow(mut socket: WebSocket<TcpStream>, first: &mpsc::Sender<()>) -> Vec<(u64, String)> {
    let mut found = Vec::new();
    while let Ok(Message::Binary(bytes)) = socket.read() {
        let time = |from: usize| u64::from_le_bytes(bytes[from..from + 8].try_into().expect("eight"));
        if bytes[0] == 1 {
            assert_eq!(bytes[1..5], 40_u32.to_le_bytes(), "the viewer's number");
            found.push((time(5), String::from_utf8_lossy(&bytes[13..]).into_owned()));
            let _ = first.send(());
        } else {
            assert_eq!((bytes[0], bytes.len()), (2, 9));
        }
    }
    found
}

#[test]
fn a_viewer_gets_every_tick_from_its_subscription_on() {
    let columns = ["heave_m", "p1_front_left_Pa"].map(Column::number);
    let mut server = Server::begin(0, "oleo hil", &columns).expect("a free port");
    let mut socket = connect(server.address(), "something, foxglove.websocket.v1").expect("let in");
    assert_eq!(text(&mut socket)["capabilities"][0], "time");
    let topics = text(&mut socket);
    assert_eq!(topics["channels"][0]["topic"], "/body");
    assert_eq!(
        (&topics["channels"][1]["id"], &topics["channels"][1]["schemaName"]),
        (&2.into(), &"oleo.Corner".into())
    );
    let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":40,"channelId":2},{"id":41,"channelId":9}]}"#;
    for request in ["nonsense", r#"{"op":"getParameters"}"#, subscribe] {
        socket.send(Message::text(request)).expect("sent");
    }
    let (first, heard) = mpsc::channel();
    let viewer = std::thread::spawn(move || follow(socket, &first));
    let mut tick = 0_u64;
    let mut offer = |server: &mut Server| {
        server.offer(tick * 5, &[Value::Number(0.0), Value::Number(tick as f64)]);
        tick += 1;
        tick
    };
    // Until the viewer has seen something, it may not have subscribed yet.
    while heard.recv_timeout(std::time::Duration::from_millis(5)).is_err() {
        offer(&mut server);
    }
    let from = offer(&mut server);
    let to = (0..500).map(|_| offer(&mut server)).last().expect("some");
    let served = server.finish();
    let found = viewer.join().expect("no panic");
    let expected: Vec<(u64, String)> = (from..to).map(|k| (k * 5, format!("{{\"p1_Pa\":{k}.0}}"))).collect();
    assert_eq!(found[found.len() - expected.len()..], expected);
    let (viewers, sent, dropped) = (1, found.len() as u64, 0);
    assert_eq!(served, Served { viewers, sent, dropped });
}

#[test]
fn a_viewer_with_another_protocol_is_refused_and_one_that_goes_is_forgotten() {
    let mut server = Server::begin(0, "oleo hil", &[Column::number("heave_m")]).expect("a free port");
    assert!(connect(server.address(), "chat").is_err_and(|why| why.contains("400")));
    drop(connect(server.address(), "foxglove.sdk.v1").expect("let in"));
    for tick in 0..100 {
        server.offer(tick, &[Value::Number(0.0)]);
    }
    assert_eq!((server.finish().sent, std::mem::size_of::<Served>()), (0, 24));
}

/// Viewers that never read: the queues fill, the loop goes on, and its commands are the same.
#[test]
fn a_silent_viewer_does_not_change_the_run() {
    let scenario = Scenario {
        ticks: 4000,
        ..scenario::named("belgian").expect("built in")
    };
    let drive =
        |watch: crate::run::Watch| both(&scenario, vehicle(&scenario).expect("a vehicle"), 1, watch).expect("a run");
    let alone = drive(&mut |_| true);
    let mut live = Live::begin(0, "oleo hil", Rows::new(false, false), false).expect("a free port");
    let _connected_only = TcpStream::connect(live.server.address()).expect("a server");
    let mut subscribed = connect(live.server.address(), "foxglove.websocket.v1").expect("let in");
    let all: Vec<_> = (1..8)
        .map(|id| serde_json::json!({ "id": id, "channelId": id }))
        .collect();
    let request = serde_json::json!({ "op": "subscribe", "subscriptions": all });
    subscribed.send(Message::text(request.to_string())).expect("sent");
    let outcome = drive(&mut |run| {
        live.watch(run);
        true
    });
    let served = live.finish(&outcome);
    let hash = |outcome: &crate::run::Outcome| command_hash(outcome.plant.recording.words());
    assert_eq!(hash(&alone), hash(&outcome));
    assert!(served.dropped > 0, "{served}");
}
