//! A server for a test, and a client that says exactly what it wants to.

use arclength_page::{Server, Site, model_site};
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// A server that runs until it is dropped.
pub(crate) struct Running {
    pub port: u16,
    stop: &'static AtomicBool,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    /// One of the page for any model.
    pub(crate) fn start() -> Self {
        Self::serve(model_site(None))
    }

    pub(crate) fn serve(site: Site) -> Self {
        let server = Server::listen(0).unwrap();
        let port = server.url().rsplit(':').next().unwrap().trim_end_matches('/').parse().unwrap();
        let stop: &AtomicBool = Box::leak(Box::default());
        let thread = std::thread::spawn(move || server.run(site, stop).unwrap());
        Self { port, stop, thread: Some(thread) }
    }

    /// Tells it to stop and waits until it has.
    pub(crate) fn end(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }

    /// Sends a request and leaves the answer to be read.
    pub(crate) fn send(&self, text: &str) -> TcpStream {
        self.send_bytes(text.as_bytes())
    }

    pub(crate) fn send_bytes(&self, bytes: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.write_all(bytes).unwrap();
        stream
    }

    /// Sends a request and reads the whole answer.
    pub(crate) fn exchange(&self, text: &str) -> Answer {
        let mut answer = Vec::new();
        self.send(text).read_to_end(&mut answer).unwrap();
        Answer::of(&String::from_utf8(answer).unwrap())
    }

    pub(crate) fn head(&self, method: &str, path: &str) -> String {
        format!("{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n", self.port)
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.exchange(&format!("{}\r\n", self.head("GET", path)))
    }

    /// The text of a request that asks with JSON.
    pub(crate) fn question(&self, path: &str, body: &str) -> String {
        let kind = "Content-Type: application/json";
        format!("{}{kind}\r\nContent-Length: {}\r\n\r\n{body}", self.head("POST", path), body.len())
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> Answer {
        self.exchange(&self.question(path, &body.to_string()))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// An answer.
#[derive(Debug)]
pub(crate) struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Answer {
    pub(crate) fn of(text: &str) -> Self {
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let is_chunked = head.to_lowercase().contains("transfer-encoding: chunked");
        let body = if is_chunked { joined(body) } else { body.to_owned() };
        Self { status, head: head.to_lowercase(), body }
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.body))
    }

    /// The message of an error.
    pub(crate) fn message(&self) -> String {
        self.json()["error"]["message"].as_str().unwrap().to_owned()
    }

    /// The events of a stream: what kind, and the text.
    pub(crate) fn events(&self) -> Vec<(String, String)> {
        let event = |text: &str| {
            let mut lines = text.split('\n');
            let kind = lines.next()?.strip_prefix("event: ")?.to_owned();
            let data: Vec<&str> = lines.map(|line| line.strip_prefix("data: ").unwrap()).collect();
            Some((kind, data.join("\n")))
        };
        self.body.split("\n\n").filter_map(event).collect()
    }

    /// The text of the result file at the end of a stream.
    pub(crate) fn result(&self) -> String {
        let (kind, text) = self.events().pop().unwrap();
        assert_eq!(kind, "result", "{text}");
        text
    }
}

/// The text of a chunked body.
fn joined(mut body: &str) -> String {
    let mut text = String::new();
    while let Some((length, rest)) = body.split_once("\r\n") {
        let length = usize::from_str_radix(length, 16).unwrap();
        text.push_str(&rest[..length]);
        body = rest[length..].trim_start_matches("\r\n");
    }
    text
}

/// A model with a Hopf point at `p = 0` and cycles of amplitude `sqrt(p)`.
pub(crate) const RADIAL: &str = "par p=-0.5\nx' = p*x - y - x*(x^2+y^2)\ny' = x + p*y - y*(x^2+y^2)\n";

/// The request of its equilibria.
pub(crate) fn equilibria() -> Value {
    serde_json::json!({
        "model": {"source": {"text": {"name": "radial.ode", "source": RADIAL}}},
        "along": {"key": "p", "start": -1.0, "end": 1.0},
    })
}
