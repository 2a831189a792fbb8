//! `pointreel serve`: a sequence file for those who play it over the network.

use super::output::answer;
use crate::reel::MAGIC;
use crate::serve::FileServer;
use anyhow::{Context as _, bail};
use clap::Args;
use std::fs::File;
use std::io::Read as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

/// Arguments of `pointreel serve`.
#[derive(Debug, Args)]
pub(super) struct ServeArgs {
    /// A sequence file (.reel); `pointreel convert` writes them
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Where to listen: an address of this machine and a port, 0 for any that is free
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8089))]
    listen: SocketAddr,
}

pub(super) fn run(arguments: &ServeArgs) -> anyhow::Result<()> {
    let path = &arguments.file;
    let mut begin = [0; MAGIC.len()];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut begin));
    read.with_context(|| format!("{} cannot be read", path.display()))?;
    if begin != MAGIC {
        bail!(
            "{} is no sequence file: make one with pointreel convert INPUT {}",
            path.display(),
            path.with_extension("reel").display()
        );
    }
    let server = FileServer::bind(path, arguments.listen);
    let server = server.with_context(|| format!("{} cannot be listened at", arguments.listen))?;
    answer(&format!("{} (play it with pointreel, end with Ctrl+C)", server.url()?));
    server.run()?;
    Ok(())
}
