//! Going down in good order, with jobs that run and streams that are open: within the bound, and nothing is lost.

use crate::common::process::{Process, client, has_ended, lines, solved, submit, until};
use crate::common::reader::{Format, Reader, Said};
use crate::common::service::{in_short_steps, indices, without_elapsed};
use arcslip::check::scenes::lattice::LatticeArch;
use std::time::Duration;

/// The indices of a stream up to where it stops.
async fn read(mut reader: Reader) -> (Vec<u64>, Said) {
    let mut indices = Vec::new();
    loop {
        match reader.next().await {
            Said::Increment(index, _) => indices.push(index),
            last => return (indices, last),
        }
    }
}

/// Models that are being checked are not waited for, nor do those pile up whose clients have gone.
#[tokio::test(flavor = "multi_thread")]
async fn checks_under_way_do_not_keep_the_service() {
    let folder = tempfile::tempdir().expect("a folder");
    let process = Process::serve(&folder.path().join("jobs.db"), &[]);
    let large = LatticeArch::of_unknowns(60_000).request().expect("a request");
    let body = serde_json::to_string(&large).expect("JSON");
    let client = client();
    let asked: Vec<_> = (0..24)
        .map(|_| {
            let ask = client.post(format!("{}/v1/jobs?validate=true", process.url)).body(body.clone());
            tokio::spawn(ask.header("content-type", "application/json").send())
        })
        .collect();
    tokio::time::sleep(Duration::from_millis(500)).await;
    let (status, took) = process.terminated().await;
    assert_eq!(status, Some(0));
    println!("ended after {took:?}");
    let mut answered = 0;
    for one in asked {
        answered += u32::from(one.await.expect("no panic").is_ok_and(|answer| answer.status() == 200));
    }
    assert!(answered < 24, "every check was waited for");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_service_that_is_asked_to_end_does_so_and_goes_on_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let requests = [in_short_steps("one-bar-truss", 20_000, 20_000), in_short_steps("klarbring", 16_000, 6000)];
    let client = client();
    let process = Process::serve(&database, &["--workers", "2"]);
    let mut ids = Vec::new();
    for request in &requests {
        ids.push(submit(&client, &process.url, "/v1/jobs", request).await);
    }
    // And one that waits.
    let waiting = submit(&client, &process.url, "/v1/jobs", &in_short_steps("klarbring", 100, 30)).await;
    let mut streams = Vec::new();
    for number in 0..20 {
        let format = if number % 3 == 0 { Format::Lines } else { Format::Events };
        let reader = Reader::open(&client, &process.url, &ids[number % 2], format, None).await;
        streams.push((number % 2, tokio::spawn(read(reader))));
    }
    for id in &ids {
        let begun = |job: &serde_json::Value| job["progress"]["increments"].as_u64() > Some(100);
        until(&client, &process.url, &format!("/v1/jobs/{id}"), begun).await;
    }
    let (status, took) = process.terminated().await;
    assert_eq!(status, Some(0));
    println!("ended after {took:?}");
    let mut broken_off = 0;
    let process = Process::serve(&database, &["--workers", "2"]);
    for (number, stream) in streams {
        let (mut seen, last) = stream.await.expect("a stream");
        if last == Said::BrokenOff {
            broken_off += 1;
            let after = seen.last().copied();
            let rest = Reader::open(&client, &process.url, &ids[number], Format::Events, after).await;
            let (rest, last) = read(rest).await;
            assert_eq!(last, Said::End);
            seen.extend(rest);
        }
        let job = until(&client, &process.url, &format!("/v1/jobs/{}", ids[number]), has_ended).await;
        let whole: Vec<u64> = (0..=job["progress"]["last_index"].as_u64().expect("an index")).collect();
        assert!(seen == whole, "{} of {}", seen.len(), whole.len());
    }
    assert!(broken_off > 0, "nothing was under way");
    for (id, request) in ids.iter().zip(&requests) {
        let undisturbed: Vec<String> = solved(request).iter().map(|line| without_elapsed(line)).collect();
        let stored = lines(&client, &process.url, id).await;
        assert!(stored.iter().map(|line| without_elapsed(line)).eq(undisturbed), "job {id}");
    }
    let job = until(&client, &process.url, &format!("/v1/jobs/{waiting}"), has_ended).await;
    assert_eq!(job["attempt"], 1);
    assert!(!indices(lines(&client, &process.url, &waiting).await.iter().map(String::as_str)).is_empty());
}
