//! `ptu ports`: serial ports found on this machine.

use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::{print_json, print_out};
use crate::failure::{Exit, Failure};

/// List serial ports; a pseudo-terminal is not listed but can be named
#[derive(Debug, Args)]
pub struct PortsArguments {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Port {
    path: String,
    kind: &'static str,
}

impl PortsArguments {
    /// Lists them.
    pub fn run(self) -> Result<Exit, Failure> {
        let ports = found()?;
        if self.json {
            return print_json(&ports);
        }
        if ports.is_empty() {
            return print_out("no serial ports found; name one with --unit serial:PATH");
        }
        let lines: Vec<_> = ports
            .iter()
            .map(|p| format!("{}  {}", p.path, p.kind))
            .collect();
        print_out(&lines.join("\n"))
    }
}

fn found() -> Result<Vec<Port>, Failure> {
    // The library panics on a Linux without /sys, as in a bare container.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports()
        .map_err(|error| Failure::bench(format!("cannot list serial ports: {error}")))?;
    let kind = |port: &serialport::SerialPortInfo| match port.port_type {
        serialport::SerialPortType::UsbPort(_) => "usb",
        serialport::SerialPortType::BluetoothPort => "bluetooth",
        serialport::SerialPortType::PciPort => "pci",
        serialport::SerialPortType::Unknown => "unknown",
    };
    Ok(ports
        .iter()
        .map(|port| Port {
            path: port.port_name.clone(),
            kind: kind(port),
        })
        .collect())
}
