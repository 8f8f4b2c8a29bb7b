//! Files that are put together byte by byte, as other programs write them.

use std::io::{Cursor, Write};
use std::ops::ControlFlow;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::*;
use crate::logs::in_memory;

/// An object with a time.
fn object(kind: u32, unit: u32, time: u64, content: &[u8]) -> Vec<u8> {
    let size = 32 + content.len() as u32;
    let head = [&b"LOBJ"[..], &[32, 0, 1, 0], &size.to_le_bytes(), &kind.to_le_bytes()].concat();
    [&head[..], &unit.to_le_bytes(), &[0; 4], &time.to_le_bytes(), content].concat()
}

/// An object of classic CAN.
fn classic(kind: u32, time_ns: u64, channel: u8, flags: u8, data: &[u8]) -> Vec<u8> {
    let mut content = vec![channel, 0, flags, data.len() as u8, 0x23, 1, 0, 0];
    content.extend(data);
    content.resize(if kind == 86 { 24 } else { 16 }, 0);
    object(kind, 2, time_ns, &content)
}

fn container(objects: &[u8], method: u8) -> Vec<u8> {
    let packed = match method {
        0 => objects.to_vec(),
        _ => {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(objects).expect("memory");
            encoder.finish().expect("memory")
        }
    };
    let size = 32 + packed.len();
    let head = [
        &b"LOBJ"[..],
        &[16, 0, 1, 0],
        &(size as u32).to_le_bytes(),
        &10_u32.to_le_bytes(),
    ]
    .concat();
    let unpacked = (objects.len() as u32).to_le_bytes();
    let mut whole = [&head[..], &[method, 0, 0, 0, 0, 0, 0, 0], &unpacked, &[0; 4], &packed].concat();
    whole.resize(size + size % 4, 0);
    whole
}

fn file(parts: &[Vec<u8>]) -> Vec<u8> {
    let mut head = [&b"LOGG"[..], &144_u32.to_le_bytes()].concat();
    head.resize(144, 0);
    [head, parts.concat()].concat()
}

type Read = (u64, String, FrameKind, Vec<u8>);

fn read(bytes: &[u8]) -> (Result<Account, String>, Vec<Read>) {
    let mut frames = Vec::new();
    let account = in_memory(bytes).and_then(|mut log| {
        log.read(&mut |entry| {
            let frame = entry.frame;
            frames.push((entry.time_us, entry.bus.to_owned(), frame.kind, frame.data().to_vec()));
            ControlFlow::Continue(())
        })
    });
    (account.map_err(|error| error.to_string()), frames)
}

#[test]
fn frames_of_every_type_are_read_and_all_else_is_counted() {
    let mut fd = vec![2, 0, 1, 9, 0x23, 1, 0, 0x80, 0, 0, 0, 0, 0, 0b011, 12, 0, 0, 0, 0, 0];
    fd.extend(0..12);
    fd.resize(20 + 64, 0);
    // Ten of 16 bytes are there, and details behind them, as CANoe writes it.
    let mut fd_64 = vec![3, 10, 16, 0, 0x23, 1, 0, 0, 0, 0, 0, 0, 0, 0x50, 0, 0];
    fd_64.resize(40, 0);
    fd_64[35] = 32 + 40 + 10;
    fd_64.extend([7; 10]);
    fd_64.extend([9; 12]);
    let mut classic_64 = vec![4, 2, 2, 0, 0x23, 1, 0, 0];
    classic_64.resize(40, 0);
    classic_64.extend([1, 2]);
    let mut request = classic(1, 0, 1, 0x80, &[]);
    request[32 + 3] = 5;
    let objects = [
        classic(1, 1_499, 1, 0, &[0xAB; 8]),
        classic(86, 1_500, 1, 1, &[1]),
        object(1, 1, 3, &classic(1, 0, 1, 0, &[2])[32..]),
        object(100, 2, 40_000, &fd),
        object(101, 2, 50_000, &fd_64),
        vec![0; 2],
        object(101, 2, 60_000, &classic_64),
        vec![0; 2],
        request,
        classic(1, 0, 1, 2, &[3]),
        object(2, 2, 0, &[1, 0, 0, 0]),
        object(73, 2, 0, &[0; 32]),
        object(65, 2, 0, b"some words"),
        vec![0; 2],
        object(1, 2, 0, &[1, 0, 0]),
    ]
    .concat();
    let (account, frames) = read(&file(&[container(&objects, 2)]));
    let one = || "1".to_owned();
    let filled = [vec![7; 10], vec![0; 6]].concat();
    assert_eq!(
        frames,
        [
            (1, one(), FrameKind::Classic, vec![0xAB; 8]),
            (2, one(), FrameKind::Classic, vec![1]),
            (30, one(), FrameKind::Classic, vec![2]),
            (40, "2".to_owned(), FrameKind::Fd(1), (0..12).collect()),
            (50, "3".to_owned(), FrameKind::Fd(2), filled),
            (60, "4".to_owned(), FrameKind::Classic, vec![1, 2]),
            (0, one(), FrameKind::Remote(5), vec![]),
        ]
    );
    let expected = Account {
        entries: 12,
        unreadable: 1,
        error_frames: 2,
        remote_frames: 1,
        without_frame: 2,
    };
    assert_eq!(account, Ok(expected));
}

/// Objects of any size are cut where a container is full, and the file may hold objects in none.
#[test]
fn objects_go_on_in_the_next_container_and_may_be_in_none() {
    let objects: Vec<u8> = (0..50).flat_map(|k| classic(1, 1000 * k, 1, 0, &[k as u8])).collect();
    for size in [1, 15, 48, 49, 1000] {
        let containers: Vec<_> = (objects.chunks(size).enumerate())
            .map(|(k, part)| container(part, [0, 2][k % 2]))
            .collect();
        let (account, frames) = read(&file(&containers));
        assert_eq!(account.map(|account| account.entries), Ok(50), "{size}");
        assert!(frames.iter().zip(0..).all(|(frame, k)| frame.3 == [k]), "{size}");
    }
    let plain = file(&[container(&objects[..96], 0), objects[96..].to_vec(), vec![0; 5]]);
    assert_eq!(read(&plain).1.len(), 50);
    // Packed as a whole, too.
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&plain).expect("memory");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.blf.gz");
    std::fs::write(&path, packed.finish().expect("memory")).expect("written");
    let account = crate::logs::open(&path).and_then(|mut log| log.read(&mut |_| ControlFlow::Continue(())));
    assert_eq!(account.expect("a log").entries, 50);
}

#[test]
fn a_file_that_was_cut_off_says_how_many_frames_were_good() {
    let objects: Vec<u8> = (0..10).flat_map(|k| classic(1, 1000 * k, 1, 0, &[k as u8])).collect();
    let first = file(&[container(&objects[..260], 2)]);
    let whole = [first.clone(), container(&objects[260..], 2)].concat();
    // How far the container is padded depends on how well it was packed; the padding is not needed, and not always told from what follows.
    let size = u32::from_le_bytes([first[152], first[153], first[154], first[155]]);
    let needed = 144 + size as usize;
    for end in [whole.len() - 20, first.len() + 1, first.len() + 17] {
        let (account, frames) = read(&whole[..end]);
        let said = account.expect_err("cut off");
        let says = |byte: usize| {
            let at = format!("in its container at byte {byte}, after 5 whole frames; ");
            said.contains(&at) && said.contains(&format!("head -c {byte}"))
        };
        assert!(says(needed) || says(first.len()), "{said}");
        assert_eq!(frames.len(), 5);
    }
    // What the advice leaves: the object that goes on in the next container is counted.
    let (account, frames) = read(&first);
    assert_eq!(
        (
            account.map(|account| (account.entries, account.unreadable)),
            frames.len()
        ),
        (Ok((6, 1)), 5)
    );
    for end in [5, 8, 143] {
        let said = read(&whole[..end]).0.expect_err("cut off");
        assert!(said.contains("after 0 whole frames"), "{said}");
    }
    assert_eq!(read(&whole[..144]).0.map(|account| account.entries), Ok(0));
}

#[test]
fn a_damaged_file_is_one_line() {
    let objects = classic(1, 0, 1, 0, &[1]);
    let good = container(&objects, 2);
    let with = |at: usize, byte: u8| {
        let mut damaged = good.clone();
        damaged[at] = byte;
        file(&[good.clone(), damaged])
    };
    let mut tiny = objects.clone();
    tiny[8] = 3;
    let other = file(&[good.clone(), b"this is not what an object begins with".to_vec()]);
    let inner = file(&[good.clone(), container(b"neither is this", 2)]);
    let cases = [
        (with(8, 1), "impossible size"),
        (with(11, 0xFF), "impossible size"),
        (with(8, 20), "too few bytes"),
        (with(16, 7), "another way than with zlib"),
        (with(40, 0xFF), "cannot be unpacked"),
        (other, "no object where one should begin"),
        (inner, "no object where one should begin"),
        (file(&[good.clone(), container(&tiny, 0)]), "shorter than its head"),
    ];
    for (bytes, what) in cases {
        let said = read(&bytes).0.expect_err("damaged");
        assert!(said.contains(what) && said.contains("after 1 whole frames"), "{said}");
    }
}

/// A container that holds far more than it should is refused before it fills the memory.
#[test]
fn a_container_that_unpacks_to_gigabytes_is_refused() {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    let zeros = vec![0; 1 << 20];
    (0..65).for_each(|_| encoder.write_all(&zeros).expect("memory"));
    let bomb = encoder.finish().expect("memory");
    let mut whole = container(&bomb, 0);
    whole[16] = 2;
    let said = read(&file(&[whole])).0.expect_err("too large");
    assert!(said.contains("cannot be unpacked"), "{said}");
}

#[test]
fn the_sink_may_end_the_reading() {
    let objects = [classic(1, 0, 1, 0, &[1]), classic(1, 0, 1, 0, &[2])].concat();
    let bytes = file(&[container(&objects, 2)]);
    let mut log = Blf::new(Box::new(Cursor::new(bytes)), "a.blf".into());
    let account = log.read(&mut |_| ControlFlow::Break(())).expect("a log");
    assert_eq!(account.entries, 1);
}
