//! Who may ask: only pages of this server, by a loopback name.
//!
//! A page of another site could otherwise reach the server through the browser, under a name of its own that resolves to the loopback
//! address. So the names in `Host` and `Origin` are compared with loopback names, not with each other; their ports must be that of this
//! server.

use crate::failure::Failure;
use axum::extract::{Request, State};
use axum::http::header::{
    CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderName, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Largest body of a request in bytes: some dozens of long branches of cycles.
pub(crate) const LARGEST_BODY: usize = 64 << 20;

/// What a page of this server may load: its own files, and the pictures within its own SVG.
const POLICY: &str = "default-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// The port of an authority that names the loopback address; nothing where it names something else.
fn loopback_port(authority: &str) -> Option<u16> {
    let (name, port) = match authority.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()?),
        _ => (authority, 80),
    };
    let is_loopback =
        ["127.0.0.1", "localhost", "[::1]"].iter().any(|known| name.eq_ignore_ascii_case(known));
    is_loopback.then_some(port)
}

/// That a request comes from this machine's user, to the server on this port, not from a page of another site.
fn check(headers: &HeaderMap, port: u16) -> Result<(), Failure> {
    let refused = |status, message: &str| Err(Failure::new(status, message));
    let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or_default());
    if text(HOST).and_then(loopback_port) != Some(port) {
        let message =
            format!("Host is not this server; allowed: 127.0.0.1:{port}, localhost:{port}, [::1]:{port}");
        return refused(StatusCode::FORBIDDEN, &message);
    }
    if let Some(origin) = text(ORIGIN) {
        let authority = origin.strip_prefix("http://").unwrap_or_default();
        if loopback_port(authority) != Some(port) {
            return refused(
                StatusCode::FORBIDDEN,
                "Origin is another site; allowed: the page of this server",
            );
        }
    }
    let length = text(CONTENT_LENGTH).and_then(|length| length.parse::<usize>().ok());
    if length.is_some_and(|length| length > LARGEST_BODY) {
        return refused(
            StatusCode::PAYLOAD_TOO_LARGE,
            "the body of the request is too large; allowed: 64 MiB",
        );
    }
    Ok(())
}

/// Whether the body says that it is JSON, as what a form of another site could send does not.
fn is_json(headers: &HeaderMap) -> bool {
    let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    kind.is_some_and(|kind| kind.starts_with("application/json"))
}

/// Refuses bodies that are no JSON, on routes that take one.
pub(crate) async fn only_json(request: Request, next: Next) -> Response {
    if is_json(request.headers()) {
        return next.run(request).await;
    }
    let message = "Content-Type; allowed: application/json";
    Failure::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, message).into_response()
}

/// Refuses requests from elsewhere and says in every answer what its page may load.
pub(crate) async fn guard(State(port): State<u16>, request: Request, next: Next) -> Response {
    let mut answer = match check(request.headers(), port) {
        Ok(()) => next.run(request).await,
        Err(failure) => failure.into_response(),
    };
    let headers = answer.headers_mut();
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_names_are_loopback_names() {
        for (authority, port) in [
            ("127.0.0.1:8000", Some(8000)),
            ("LOCALHOST:1", Some(1)),
            ("localhost", Some(80)),
            ("[::1]:9", Some(9)),
            ("[::1]", Some(80)),
            ("localhost.example.org:8000", None),
            ("127.0.0.1.example.org", None),
            ("example.org:8000", None),
            ("localhost:", None),
            ("localhost:99999", None),
            ("", None),
        ] {
            assert_eq!(loopback_port(authority), port, "{authority}");
        }
    }

    #[test]
    fn pages_of_other_sites_are_refused() {
        let headers = |entries: &[(HeaderName, &str)]| -> HeaderMap {
            entries.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
        };
        let asked = |entries: &[(HeaderName, &str)]| check(&headers(entries), 8000).is_ok();
        let host = (HOST, "127.0.0.1:8000");
        assert!(asked(std::slice::from_ref(&host)));
        assert!(asked(&[host.clone(), (ORIGIN, "http://localhost:8000")]));
        // Another server on this machine, which this one is not.
        assert!(!asked(&[(HOST, "localhost:1")]));
        assert!(!asked(&[(HOST, "localhost:1"), (ORIGIN, "http://localhost:1")]));
        assert!(!asked(&[(HOST, "localhost")]));
        // A name of another site that resolves to this machine; another server on this machine; a sandboxed frame.
        assert!(!asked(&[(HOST, "rebound.example.org:8000")]));
        assert!(!asked(&[host.clone(), (ORIGIN, "http://rebound.example.org:8000")]));
        assert!(!asked(&[host.clone(), (ORIGIN, "http://localhost:3000")]));
        assert!(!asked(&[host, (ORIGIN, "null")]));
        assert!(!asked(&[]));
        // A form.
        assert!(is_json(&headers(&[(CONTENT_TYPE, "application/json; charset=utf-8")])));
        assert!(!is_json(&headers(&[(CONTENT_TYPE, "text/plain")])) && !is_json(&headers(&[])));
    }
}
