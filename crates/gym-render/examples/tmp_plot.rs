fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let values: Vec<f64> = (0..200).map(|i| (i as f64 * 0.3).sin() * 40.0).collect();
    let mut plot = gym_render::Plot::new("a")
        .y_label("return")
        .series("s", &values)
        .moving_average(10);
    for _ in 0..n {
        plot = plot.below(
            gym_render::Plot::new("b")
                .y_label("r")
                .series("s", &values)
                .moving_average(10),
        );
    }
    let t = std::time::Instant::now();
    plot.write_svg("/tmp/edges.svg").unwrap();
    println!("svg {:?}", t.elapsed());
    let t = std::time::Instant::now();
    plot.write_png("/tmp/edges.png").unwrap();
    println!("png {:?}", t.elapsed());
}
