//! The hub, which makes messages of rows for all viewers at once, and the thread that lets viewers in.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded, unbounded};

use super::super::topic::{Column, Topic, Value};
use super::protocol;
use super::served::Served;
use super::viewer::{self, Greeting, Messages};

/// Rows that wait for the hub: five seconds of driving.
const ROWS_WAITING: usize = 1000;
/// Ticks that wait for a viewer: five seconds of driving.
const TICKS_WAITING: usize = 1000;
/// Viewers at one time.
const MOST_VIEWERS: usize = 8;
/// How often the server looks for viewers.
const LOOK: Duration = Duration::from_millis(20);

struct Row {
    time_ns: u64,
    values: Vec<Value>,
}

/// A viewer that was let in: the way to it, and its thread, which says how many ticks it has sent.
struct Viewer {
    messages: Sender<Arc<Messages>>,
    thread: JoinHandle<u64>,
}

/// Threads that serve viewers.
pub struct Server {
    address: SocketAddr,
    rows: Sender<Row>,
    /// Rows that the hub did not take in time, which no viewer has.
    overflow: u64,
    is_over: Arc<AtomicBool>,
    door: JoinHandle<()>,
    hub: JoinHandle<Served>,
}

impl Server {
    /// Begins to listen.
    pub fn begin(port: u16, name: &str, columns: &[Column]) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let topics = Topic::of(None, columns);
        let greeting = Arc::new(Greeting {
            server_info: protocol::server_info(name),
            advertise: protocol::advertise(&topics),
        });
        let is_over = Arc::new(AtomicBool::new(false));
        let (newcomers, came) = unbounded();
        let (rows, taken) = bounded(ROWS_WAITING);
        let over = Arc::clone(&is_over);
        let door = std::thread::Builder::new()
            .name("viewers".into())
            .spawn(move || let_in(&listener, &newcomers, &greeting, &over))?;
        let hub = std::thread::Builder::new()
            .name("messages".into())
            .spawn(move || serve(&topics, &taken, &came))?;
        Ok(Self {
            address,
            rows,
            overflow: 0,
            is_over,
            door,
            hub,
        })
    }

    /// Where viewers connect.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Gives a row to the hub, or leaves it out where the hub is behind.
    pub fn offer(&mut self, time_ns: u64, values: &[Value]) {
        let values = values.to_vec();
        if self.rows.try_send(Row { time_ns, values }).is_err() {
            self.overflow += 1;
        }
    }

    /// Ends all threads. Viewers get what waits for them, as far as they take it.
    pub fn finish(self) -> Served {
        self.is_over.store(true, Ordering::Relaxed);
        let _ = self.door.join();
        drop(self.rows);
        let mut served = self.hub.join().unwrap_or_default();
        served.dropped += self.overflow * served.viewers;
        served
    }
}

/// Lets viewers in until the run is over.
fn let_in(listener: &TcpListener, newcomers: &Sender<Viewer>, greeting: &Arc<Greeting>, is_over: &AtomicBool) {
    let mut ways: Vec<std::sync::Weak<()>> = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        let Ok((stream, _)) = listener.accept() else {
            std::thread::sleep(LOOK);
            continue;
        };
        ways.retain(|way| way.strong_count() > 0);
        if ways.len() >= MOST_VIEWERS {
            continue;
        }
        let is_here = Arc::new(());
        ways.push(Arc::downgrade(&is_here));
        if let Some(viewer) = begin_viewer(stream, greeting, is_here) {
            let _ = newcomers.send(viewer);
        }
    }
}

/// Starts the thread of a viewer; `is_here` lives as long as the thread.
fn begin_viewer(stream: TcpStream, greeting: &Arc<Greeting>, is_here: Arc<()>) -> Option<Viewer> {
    let (messages, waiting) = bounded(TICKS_WAITING);
    let greeting = Arc::clone(greeting);
    let thread = std::thread::Builder::new().name("viewer".into()).spawn(move || {
        let sent = viewer::serve(stream, &greeting, &waiting);
        drop(is_here);
        sent
    });
    let thread = thread.ok()?;
    Some(Viewer { messages, thread })
}

/// Makes messages of the rows until there are no more.
fn serve(topics: &[Topic], rows: &Receiver<Row>, newcomers: &Receiver<Viewer>) -> Served {
    let mut served = Served::default();
    let (mut viewers, mut parted): (Vec<Viewer>, Vec<JoinHandle<u64>>) = (Vec::new(), Vec::new());
    for row in rows {
        viewers.extend(newcomers.try_iter());
        if viewers.is_empty() {
            continue;
        }
        let text_of = |topic: &Topic| {
            let mut text = Vec::new();
            topic.write(&row.values, &mut text);
            text
        };
        let messages = Arc::new(Messages {
            time_ns: row.time_ns,
            texts: topics.iter().map(text_of).collect(),
        });
        for at in (0..viewers.len()).rev() {
            match viewers[at].messages.try_send(Arc::clone(&messages)) {
                Ok(()) => {}
                Err(TrySendError::Full(_)) => served.dropped += 1,
                Err(TrySendError::Disconnected(_)) => parted.push(viewers.swap_remove(at).thread),
            }
        }
    }
    viewers.extend(newcomers.try_iter());
    // Each thread ends when the way to it is closed.
    parted.extend(viewers.into_iter().map(|viewer| viewer.thread));
    served.viewers = parted.len() as u64;
    served.sent = parted.into_iter().filter_map(|thread| thread.join().ok()).sum();
    served
}
