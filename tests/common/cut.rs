//! A line that can be cut: a TCP proxy on loopback.

use std::net::SocketAddr;
use std::sync::Arc;
use tokio::io::copy_bidirectional;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio_util::task::AbortOnDropHandle;

/// How the line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Line {
    Whole,
    /// Connections end, and none is made.
    Cut,
    /// Connections stay, and nothing comes through.
    Dumb,
}

pub struct Proxy {
    address: SocketAddr,
    line: Arc<watch::Sender<Line>>,
    _task: AbortOnDropHandle<()>,
}

impl Proxy {
    pub async fn to(port: u16) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("its address");
        let line = Arc::new(watch::Sender::new(Line::Whole));
        let task = tokio::spawn(accept(listener, port, Arc::clone(&line)));
        Self { address, line, _task: AbortOnDropHandle::new(task) }
    }

    /// A URL that goes through it instead.
    pub fn of(&self, url: &str, port: u16) -> String {
        let through = url.replace(&format!(":{port}/"), &format!(":{}/", self.address.port()));
        assert_ne!(through, url);
        through
    }

    pub fn cut(&self) {
        self.line.send_replace(Line::Cut);
    }

    pub fn dumb(&self) {
        self.line.send_replace(Line::Dumb);
    }

    pub fn whole(&self) {
        self.line.send_replace(Line::Whole);
    }
}

async fn accept(listener: TcpListener, port: u16, line: Arc<watch::Sender<Line>>) {
    while let Ok((near, _)) = listener.accept().await {
        if *line.borrow() != Line::Cut {
            tokio::spawn(carry(near, port, line.subscribe()));
        }
    }
}

async fn carry(mut near: TcpStream, port: u16, mut line: watch::Receiver<Line>) {
    let Ok(mut far) = TcpStream::connect(("127.0.0.1", port)).await else { return };
    loop {
        tokio::select! {
            biased;
            changed = line.changed() => {
                if changed.is_err() || *line.borrow_and_update() == Line::Cut {
                    return;
                }
                while *line.borrow_and_update() == Line::Dumb {
                    if line.changed().await.is_err() {
                        return;
                    }
                }
                // What stood in the line for so long may have been given up; what is left of it goes on its way.
                if *line.borrow() == Line::Cut {
                    return;
                }
            }
            _ = copy_bidirectional(&mut near, &mut far) => return,
        }
    }
}
