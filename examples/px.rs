fn main() {
    let a: Vec<String> = std::env::args().collect();
    let d = std::fs::read(&a[1]).unwrap();
    let w: u32 = a[2].parse().unwrap();
    let tree = usvg::Tree::from_data(&d, &Default::default()).unwrap();
    let s = toon_raster::Scene::from_tree(&tree).unwrap();
    let h = ((w as f64) * s.size().height / s.size().width).round() as u32;
    let mut r =
        toon_raster::Renderer::new(toon_raster::Settings { threads: 1, ..Default::default() }).unwrap();
    let p = r.render(&s, &toon_raster::Viewport::fit(&s, w, h)).unwrap();
    for q in &a[3..] {
        let v: Vec<u32> = q.split(',').map(|s| s.parse().unwrap()).collect();
        println!("{q} {:?}", p.pixel(v[0], v[1]));
    }
}
