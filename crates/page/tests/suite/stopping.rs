//! Computations end when they are told to, when nobody waits for them, and when the server ends.

use crate::client::{Answer, Running, equilibria};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read};
use std::net::TcpStream;

/// A branch with so many steps that it takes minutes.
fn long() -> Value {
    let mut request = equilibria();
    request["finer"] = json!(100_000);
    request["steps"] = json!(10_000_000);
    json!({"request": request})
}

/// Asks for it and waits for its number and its first point: the answer so far, and what follows.
fn begin(server: &Running) -> (BufReader<TcpStream>, String, u64) {
    let stream = server.send(&server.question("/api/equilibria", &long().to_string()));
    let mut answer = BufReader::new(stream);
    let (mut text, mut number) = (String::new(), 0);
    loop {
        let (mut line, is_number) = (String::new(), text.ends_with("event: run\n"));
        assert!(answer.read_line(&mut line).unwrap() > 0, "the stream ended");
        text.push_str(&line);
        if is_number {
            number = line.trim().strip_prefix("data: ").unwrap().parse().unwrap();
        }
        if line.starts_with("event: point") {
            return (answer, text, number);
        }
    }
}

#[test]
fn what_is_stopped_gives_what_there_is() {
    let server = Running::start();
    let (mut answer, mut text, number) = begin(&server);
    assert_eq!(server.post("/api/stop", &json!({"run": number})).body, "true");
    answer.read_to_string(&mut text).unwrap();
    let result = Answer::of(&text).result();
    let result: Value = serde_json::from_str(&result).unwrap();
    assert!(result["ends"][1]["cause"].as_str().unwrap().contains("interrupted"), "{}", result["ends"]);
    // The stop may come before a second point is computed.
    let told = text.matches("event: point\n").count();
    assert!(told > 0 && result["points"].as_array().unwrap().len() >= told, "{told} points were told");
    assert_eq!(server.post("/api/stop", &json!({"run": number})).body, "false");
}

#[test]
fn what_nobody_waits_for_makes_room() {
    let server = Running::start();
    let at_once = std::thread::available_parallelism().map_or(1, usize::from);
    for _ in 0..2 {
        let all: Vec<_> = (0..at_once).map(|_| begin(&server)).collect();
        drop(all);
        // Would wait for minutes if they went on.
        assert_eq!(server.post("/api/equilibria", &json!({"request": equilibria()})).status, 200);
    }
}

#[test]
fn many_at_once_are_all_answered_alike() {
    let server = Running::start();
    let expected = server.post("/api/equilibria", &json!({"request": equilibria()})).result();
    std::thread::scope(|scope| {
        let ask =
            || scope.spawn(|| server.post("/api/equilibria", &json!({"request": equilibria()})).result());
        let all: Vec<_> = (0..200).map(|_| ask()).collect();
        assert!(all.into_iter().all(|answer| answer.join().unwrap() == expected));
    });
}

#[test]
fn the_server_ends_in_the_middle_of_a_computation() {
    let mut server = Running::start();
    let (mut answer, ..) = begin(&server);
    // Joins the thread of the server, which waits for no branch.
    server.end();
    let mut rest = Vec::new();
    // The connection may be cut while something is under way.
    let _ = answer.read_to_end(&mut rest);
    assert!(TcpStream::connect(("127.0.0.1", server.port)).is_err());
}
