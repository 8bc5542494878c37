//! The service and the commands, each as its callers meet it.

#[path = "../common/mod.rs"]
mod common;

mod access;
mod backup;
mod changes;
mod checks;
mod client;
mod curves;
mod dashboard;
mod disk;
mod errors;
mod examples;
mod export;
mod faults;
mod follow;
mod hosts;
mod interface;
mod jobs;
mod kills;
mod limits;
mod listen;
mod lists;
mod load;
mod manual;
mod measure;
mod metrics;
mod plot;
mod poison;
mod restart;
mod resume;
mod settings;
mod shutdown;
mod stopped_clock;
mod store_jobs;
mod store_leases;
mod store_postgres;
mod store_queue;
mod store_turns;
mod streams;
mod studies;
mod study_command;
mod sweep_command;
mod sweeps;
mod tags;
mod verify_command;
