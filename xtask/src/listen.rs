//! An address to serve on.

use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, ToSocketAddrs as _};

use anyhow::{Context as _, Result, anyhow};

/// Turns `HOST:PORT` into an address that is free now; port 0 becomes a free port. An address that is taken is an
/// error here, before anything is built or started.
pub fn free_address(listen: &str) -> Result<SocketAddr> {
    let address = listen
        .to_socket_addrs()
        .with_context(|| format!("'{listen}' is no address to listen on (such as 127.0.0.1:8787)"))?
        .next()
        .with_context(|| format!("'{listen}' names no address"))?;
    let socket = TcpListener::bind(address).map_err(|cause| match cause.kind() {
        ErrorKind::AddrInUse => {
            anyhow!("{address} is in use by another program: choose another with --listen")
        }
        _ => anyhow!("cannot listen on {address}: {cause}"),
    })?;
    socket.local_addr().with_context(|| format!("cannot listen on {address}"))
}

/// Where a client on this machine reaches a server that listens on `address`, which may stand for all interfaces.
pub fn reachable(mut address: SocketAddr) -> SocketAddr {
    if address.ip().is_unspecified() {
        let v4 = address.is_ipv4();
        address.set_ip(if v4 { IpAddr::V4(Ipv4Addr::LOCALHOST) } else { IpAddr::V6(Ipv6Addr::LOCALHOST) });
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn port_zero_becomes_a_free_port() {
        let address = free_address("127.0.0.1:0").expect("there is a free port");
        assert_ne!(address.port(), 0);
        TcpListener::bind(address).expect("it is free");
    }

    #[test]
    fn a_taken_port_is_one_clear_line() {
        let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = taken.local_addr().expect("bound").to_string();
        let cause = format!("{:#}", free_address(&address).expect_err("taken"));
        assert!(cause.contains(&address) && cause.contains("in use") && !cause.contains('\n'), "{cause}");
    }

    #[test]
    fn nonsense_is_refused() {
        for nonsense in ["", "8787", "127.0.0.1", "127.0.0.1:99999", "127.0.0.1:x"] {
            free_address(nonsense).expect_err(nonsense);
        }
    }

    #[test]
    fn all_interfaces_are_reached_on_the_loopback() {
        let reached = |address: &str| reachable(address.parse().expect("an address")).to_string();
        assert_eq!(reached("0.0.0.0:80"), "127.0.0.1:80");
        assert_eq!(reached("[::]:80"), "[::1]:80");
        assert_eq!(reached("127.0.0.2:80"), "127.0.0.2:80");
    }
}
