use toon_raster::{reference, Scene, Viewport};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let d = std::fs::read(&a[1]).unwrap();
    let w: u32 = a[2].parse().unwrap();
    let tree = usvg::Tree::from_data(&d, &Default::default()).unwrap();
    let s = Scene::from_tree(&tree).unwrap();
    let h = ((w as f64) * s.size().height / s.size().width).round() as u32;
    let t = reference::render(&tree, &Viewport::fit(&s, w, h), &Default::default()).unwrap();
    println!("{:?}", t.straight(a[3].parse().unwrap(), a[4].parse().unwrap()));
}
