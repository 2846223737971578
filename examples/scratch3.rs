use octagloss::oem::*;
use octagloss::*;
fn main() {
    let (w, h) = (512u32, 256u32);
    let n: u32 = std::env::args().nth(1).unwrap().parse().unwrap();
    let b: u32 = std::env::args().nth(2).unwrap().parse().unwrap();
    let t: Vec<[f32; 3]> = (0..w * h).map(|k| [(k % 97) as f32 * 0.1; 3]).collect();
    let e = Environment::new(Layout::Panorama { width: w as u32, height: h as u32 }, t).unwrap();
    for _ in 0..4 {
        let t = std::time::Instant::now();
        let o = cpu::reparameterise::oem_from_environment(&e, OemSize { inner: n, border: 0 }).unwrap();
        let a = t.elapsed();
        let t = std::time::Instant::now();
        let c = cpu::cells::Cells::new(&o, b, cpu::tent::Reconstruction::Constant);
        let bb = t.elapsed();
        std::hint::black_box(&c);
        let t = std::time::Instant::now();
        let s = sat::Sat::new(&o, sat::Scan::Strips);
        let cc = t.elapsed();
        std::hint::black_box(&s);
        println!("oem {a:?} cells {bb:?} sat {cc:?}");
    }
}
