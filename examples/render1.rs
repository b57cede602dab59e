fn main() {
    let a: Vec<String> = std::env::args().collect();
    let d = std::fs::read(&a[1]).unwrap();
    let w: u32 = a[3].parse().unwrap();
    let n: usize = a.get(4).map_or(1, |s| s.parse().unwrap());
    let t0 = std::time::Instant::now();
    let mut opt = usvg::Options::default();
    if d.windows(5).any(|w| w == b"<text") {
        opt.fontdb_mut().load_system_fonts();
    }
    let tree = usvg::Tree::from_data(&d, &opt).unwrap();
    let t1 = t0.elapsed();
    let s = toon_raster::Scene::from_tree(&tree).unwrap();
    println!("parse {t1:?} scene {:?}", t0.elapsed() - t1);
    for x in s.warnings() {
        println!("{x:?}");
    }
    let h = ((w as f64) * s.size().height / s.size().width).round().max(1.) as u32;
    let thr = std::env::var("T").ok().map_or(1, |s| s.parse().unwrap());
    let tol =
        std::env::var("TOL").ok().map_or(toon_raster::Settings::DEFAULT_TOLERANCE, |s| s.parse().unwrap());
    let mut r = toon_raster::Renderer::new(toon_raster::Settings {
        threads: thr,
        tolerance: tol,
        ..Default::default()
    })
    .unwrap();
    let v = toon_raster::Viewport::fit(&s, w, h);
    let mut p = r.render(&s, &v).unwrap();
    let mut ts = vec![];
    for _ in 0..n {
        let t = std::time::Instant::now();
        let st = p.stride();
        r.render_into(&s, &v, p.data_mut(), st).unwrap();
        ts.push(t.elapsed());
    }
    ts.sort();
    println!("{}x{} raster median {:?} min {:?}", w, h, ts[n / 2], ts[0]);
    println!("{:?}", r.stages());
    let f = std::fs::File::create(&a[2]).unwrap();
    let mut e = png::Encoder::new(f, w, h);
    e.set_color(png::ColorType::Rgba);
    e.set_depth(png::BitDepth::Eight);
    e.write_header().unwrap().write_image_data(p.data()).unwrap();
    if std::env::var("CMP").is_ok() {
        let mut px = tiny_skia::Pixmap::new(w, h).unwrap();
        let tr =
            tiny_skia::Transform::from_scale(w as f32 / tree.size().width(), h as f32 / tree.size().height());
        let mut ts = vec![];
        for _ in 0..n {
            px.fill(tiny_skia::Color::TRANSPARENT);
            let t = std::time::Instant::now();
            resvg::render(&tree, tr, &mut px.as_mut());
            ts.push(t.elapsed());
        }
        ts.sort();
        println!("resvg median {:?}", ts[n / 2]);
        let mut m = 0f64;
        let mut mx = 0;
        for (i, q) in px.pixels().iter().enumerate() {
            let q = q.demultiply();
            let o = &p.data()[i * 4..i * 4 + 4];
            for (a, b) in [q.red(), q.green(), q.blue(), q.alpha()].iter().zip(o) {
                let d = (*a as i32 * q.alpha() as i32 - *b as i32 * o[3] as i32).abs() / 255;
                m += d as f64;
                mx = mx.max(d);
            }
        }
        println!("vs resvg mean {} max {}", m / (w * h * 4) as f64, mx);
    }
}
