//! The textures of a model: patterns and files as pixels. The patterns and the order of a cube's
//! faces are those of MuJoCo 3.12 (`user_objects.cc`, Apache-2.0).

use std::collections::HashSet;
use std::path::Path;

use png::{ColorType, Decoder, Limits, Transformations};

use crate::Result;
use crate::error::ensure;
use crate::math::libm;
use crate::mjcf::spec::{Mark, Pattern, Pixels, Spec, Texture};
use crate::mjcf::store::Assets;
use crate::model::{CompiledModel, TextureType};

/// The largest number of bytes of all textures together.
const MOST: usize = 512 << 20;
/// The largest number of pixels of a pattern.
const MOST_OF_PATTERN: usize = 16 << 20;

/// Adds the textures that materials have, and the materials.
pub(super) fn add_textures(
    m: &mut CompiledModel,
    spec: &Spec,
    assets: &mut Assets<'_>,
) -> Result<()> {
    let mut names = HashSet::new();
    for Texture { name, place, .. } in &spec.textures {
        if !name.is_empty() && !names.insert(name) {
            return Err(place.attribute("name", format!("there is a texture {name:?} already")));
        }
    }
    for material in &spec.materials {
        let id = match &material.texture {
            None => -1,
            Some(name) => {
                let found = spec
                    .textures
                    .iter()
                    .position(|texture| texture.name == *name);
                let missing = || format!("there is no texture {name:?}");
                found.ok_or_else(|| material.place.attribute("texture", missing()))? as i32
            }
        };
        m.mat_texid.push(id);
        m.mat_texrepeat.push(material.repeat);
        m.mat_texuniform.push(material.uniform);
        m.mat_emission.push(material.emission);
        m.mat_specular.push(material.specular);
        m.mat_shininess.push(material.shininess);
    }
    let mut maker = Maker {
        assets,
        bytes: MOST,
    };
    let used: HashSet<i32> = m.mat_texid.iter().copied().collect();
    let all = &mut *m.textures;
    for (id, texture) in spec.textures.iter().enumerate() {
        let image = match used.contains(&(id as i32)) {
            true => maker
                .make(texture)
                .map_err(|(attribute, reason)| texture.place.attribute(attribute, reason))?,
            false => Image::default(),
        };
        all.tex_type.push(texture.kind);
        all.tex_width.push(image.width);
        all.tex_height.push(image.height);
        all.tex_nchannel.push(texture.channels);
        all.tex_adr.push(all.tex_data.len());
        all.tex_data.extend(image.bytes);
    }
    Ok(())
}

/// Checks the arrays of textures and materials.
pub(super) fn check(m: &CompiledModel) -> Result<()> {
    let t = &m.textures;
    let count = t.tex_type.len();
    for (name, length) in [
        ("tex_width", t.tex_width.len()),
        ("tex_height", t.tex_height.len()),
        ("tex_nchannel", t.tex_nchannel.len()),
        ("tex_adr", t.tex_adr.len()),
    ] {
        ensure!(
            length == count,
            "{name} has {length} elements, expected {count}"
        );
    }
    let mut next = 0;
    for i in 0..count {
        let (width, height, channels) = (t.tex_width[i], t.tex_height[i], t.tex_nchannel[i]);
        ensure!(
            [1, 3, 4].contains(&channels),
            "tex_nchannel[{i}] is {channels}: use 1, 3 or 4"
        );
        ensure!(
            t.tex_type[i] == TextureType::Flat
                || height == width
                || width.checked_mul(6) == Some(height),
            "tex_height[{i}] is {height}: a cube of width {width} has that height, or 6 times"
        );
        let bytes = width
            .checked_mul(height)
            .and_then(|n| n.checked_mul(channels));
        let left = t.tex_data.len() - next;
        ensure!(
            t.tex_adr[i] == next && bytes.is_some_and(|bytes| bytes <= left),
            "texture {i} does not follow the one before in tex_data"
        );
        next += bytes.unwrap_or_default();
    }
    ensure!(
        next == t.tex_data.len(),
        "tex_data has {} elements, expected {next}",
        t.tex_data.len()
    );
    for (i, &id) in m.mat_texid.iter().enumerate() {
        let exists = usize::try_from(id).is_ok_and(|id| id < count);
        ensure!(
            exists || id == -1,
            "mat_texid[{i}] is {id}, and there are {count} textures"
        );
    }
    Ok(())
}

/// The pixels of a texture, or of a file.
#[derive(Default)]
struct Image {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

/// An attribute at fault, and the reason.
type Fault = (&'static str, String);

/// Makes images of limited size.
struct Maker<'a, 'files> {
    assets: &'a mut Assets<'files>,
    /// How many bytes of pixels may follow.
    bytes: usize,
}

impl Maker<'_, '_> {
    fn make(&mut self, texture: &Texture) -> Result<Image, Fault> {
        let cube = texture.kind != TextureType::Flat;
        match &texture.pixels {
            Pixels::Pattern(pattern) => self.pattern(texture, *pattern, cube),
            Pixels::File(path) if cube => self.cube_of_file(texture, path),
            Pixels::File(path) => self.file(texture, path).map_err(|reason| ("file", reason)),
            Pixels::Faces(paths) => self.cube_of_faces(texture, paths),
        }
    }

    /// An image without content, if there is room.
    fn empty(&mut self, [width, height]: [usize; 2], channels: usize) -> Result<Image, String> {
        let bytes = width
            .checked_mul(height)
            .and_then(|n| n.checked_mul(channels));
        let left = bytes.and_then(|bytes| self.bytes.checked_sub(bytes));
        let reason =
            format!("the textures together have more than {MOST} bytes: make them smaller");
        self.bytes = left.ok_or(reason)?;
        Ok(Image {
            width,
            height,
            bytes: vec![0; bytes.unwrap_or_default()],
        })
    }

    fn pattern(&mut self, texture: &Texture, pattern: Pattern, cube: bool) -> Result<Image, Fault> {
        let [width, height] = texture.size;
        let sides = if cube {
            [width, width.saturating_mul(6)]
        } else {
            [width, height]
        };
        if sides.contains(&0) {
            return Err((
                "builtin",
                "needs a width and a height, in pixels".to_owned(),
            ));
        }
        if sides[0].saturating_mul(sides[1]) > MOST_OF_PATTERN {
            let reason =
                format!("a pattern of more than {MOST_OF_PATTERN} pixels: make it smaller");
            return Err(("width", reason));
        }
        if texture.channels != 3 {
            return Err(("nchannel", "a builtin pattern has 3".to_owned()));
        }
        let mut image = self.empty(sides, 3).map_err(|reason| ("width", reason))?;
        let faces = if cube { 6 } else { 1 };
        let pixels = image.bytes.as_chunks_mut().0;
        for (face, pixels) in pixels
            .chunks_exact_mut(width * sides[1] / faces)
            .enumerate()
        {
            let paint = Paint {
                texture,
                pattern,
                face: cube.then_some(face),
                size: [width, sides[1] / faces],
            };
            for (i, pixel) in pixels.iter_mut().enumerate() {
                *pixel = paint.at(i % width, i / width);
            }
        }
        Ok(image)
    }

    /// The image of a PNG file, with the texture's number of channels.
    fn file(&mut self, texture: &Texture, path: &Path) -> Result<Image, String> {
        let fault = |reason: String| format!("{}: {reason}", path.display());
        let bytes = self.assets.read(path).map_err(fault)?;
        let not_png = |error: png::DecodingError| fault(format!("this is no PNG file: {error}"));
        let limits = Limits { bytes: MOST };
        let mut decoder = Decoder::new_with_limits(std::io::Cursor::new(bytes), limits);
        decoder.set_transformations(Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(not_png)?;
        let (width, height) = (reader.info().width as usize, reader.info().height as usize);
        let mut image = self
            .empty([width, height], texture.channels)
            .map_err(fault)?;
        let (color, _) = reader.output_color_type();
        let size = reader.output_buffer_size().filter(|size| *size <= 4 * MOST);
        let mut pixels = vec![0; size.ok_or_else(|| fault("the image is too large".to_owned()))?];
        reader.next_frame(&mut pixels).map_err(not_png)?;
        let samples = color.samples();
        let new = image.bytes.chunks_exact_mut(texture.channels);
        for (to, from) in new.zip(pixels.chunks_exact(samples)) {
            let [red, green, blue, opacity] = match (color, from) {
                (ColorType::Grayscale, [grey]) => [*grey, *grey, *grey, 255],
                (ColorType::GrayscaleAlpha, [grey, opacity]) => [*grey, *grey, *grey, *opacity],
                (_, [red, green, blue, rest @ ..]) => {
                    [*red, *green, *blue, rest.first().copied().unwrap_or(255)]
                }
                _ => [0; 4],
            };
            to.copy_from_slice(&[red, green, blue, opacity][..to.len()]);
        }
        turn(&mut image, texture);
        Ok(image)
    }

    /// A cube from one file: one face for all sides, or a grid of faces.
    fn cube_of_file(&mut self, texture: &Texture, path: &Path) -> Result<Image, Fault> {
        let image = self
            .file(texture, path)
            .map_err(|reason| ("file", reason))?;
        let [rows, columns] = texture.grid;
        let width = image.width / columns;
        if width * columns != image.width || width * rows != image.height {
            let reason = format!(
                "a cube's faces are squares, and {}x{} pixels do not divide into {rows} rows and \
                 {columns} columns of them",
                image.width, image.height
            );
            return Err(("gridsize", reason));
        }
        if texture.grid == [1, 1] {
            return Ok(image);
        }
        let mut cube = self
            .blank_cube(texture, width)
            .map_err(|reason| ("file", reason))?;
        for (k, letter) in texture.layout.iter().take(rows * columns).enumerate() {
            if let Some(face) = b"RLUDFB".iter().position(|face| face == letter) {
                let corner = [k % columns * width, k / columns * width];
                put(&mut cube, face, &image, corner, texture.channels);
            }
        }
        Ok(cube)
    }

    /// A cube from a file for each face.
    fn cube_of_faces(
        &mut self,
        texture: &Texture,
        paths: &[Option<std::path::PathBuf>; 6],
    ) -> Result<Image, Fault> {
        let fault = |reason: String| ("file", reason);
        let mut cube: Option<Image> = None;
        for (face, path) in paths.iter().enumerate() {
            let Some(path) = path else { continue };
            let image = self.file(texture, path).map_err(fault)?;
            let width = cube.as_ref().map_or(image.width, |cube| cube.width);
            if [image.width, image.height] != [width; 2] {
                let (wide, high) = (image.width, image.height);
                let reason = format!("a face of {wide}x{high} pixels, not of {width}x{width}");
                return Err(("file", format!("{}: {reason}", path.display())));
            }
            let mut whole = match cube.take() {
                Some(cube) => cube,
                None => self.blank_cube(texture, width).map_err(fault)?,
            };
            put(&mut whole, face, &image, [0, 0], texture.channels);
            cube = Some(whole);
        }
        cube.ok_or_else(|| fault("missing".to_owned()))
    }

    /// A cube whose faces have the texture's first colour.
    fn blank_cube(&mut self, texture: &Texture, width: usize) -> Result<Image, String> {
        let mut cube = self.empty([width, width.saturating_mul(6)], texture.channels)?;
        let [r, g, b] = bytes(texture.rgb[0]);
        for pixel in cube.bytes.chunks_exact_mut(texture.channels) {
            pixel.copy_from_slice(&[r, g, b, 255][..pixel.len()]);
        }
        Ok(cube)
    }
}

/// Copies a square of an image to a face of a cube.
fn put(cube: &mut Image, face: usize, image: &Image, [left, top]: [usize; 2], channels: usize) {
    let row = cube.width * channels;
    for y in 0..cube.width {
        let from = ((top + y) * image.width + left) * channels;
        let to = (face * cube.width + y) * row;
        cube.bytes[to..to + row].copy_from_slice(&image.bytes[from..from + row]);
    }
}

/// Turns an image left to right or upside down, as the texture says.
fn turn(image: &mut Image, texture: &Texture) {
    let [sideways, upside_down] = texture.flip;
    let row = image.width * texture.channels;
    if row == 0 {
        return;
    }
    if sideways {
        for row in image.bytes.chunks_exact_mut(row) {
            row.reverse();
            for pixel in row.chunks_exact_mut(texture.channels) {
                pixel.reverse();
            }
        }
    }
    if upside_down {
        let rows = image.bytes.chunks_exact(row).rev();
        image.bytes = rows.flatten().copied().collect();
    }
}

/// A colour as bytes, rounded down.
fn bytes(rgb: [f64; 3]) -> [u8; 3] {
    rgb.map(|x| (255.0 * x) as u8)
}

/// A pattern on a rectangle, or on a face of a cube.
struct Paint<'a> {
    texture: &'a Texture,
    pattern: Pattern,
    face: Option<usize>,
    size: [usize; 2],
}

impl Paint<'_> {
    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let [width, height] = self.size;
        let marked = match self.texture.mark {
            Mark::None => false,
            Mark::Edge => x == 0 || y == 0 || x == width - 1 || y == height - 1,
            Mark::Cross => x == width / 2 || y == height / 2,
        };
        if marked {
            return bytes(self.texture.mark_rgb);
        }
        let [first, second] = self.texture.rgb;
        match self.pattern {
            Pattern::Gradient => self.gradient(x, y),
            Pattern::Checker => {
                let same = (x < width / 2) == (y < height / 2);
                // the front and the back begin with the other colour
                let turned = self.face.is_some_and(|face| face >= 4);
                bytes(if same == turned { second } else { first })
            }
            // the lower face has the second colour
            Pattern::Flat => bytes(if self.face == Some(3) { second } else { first }),
        }
    }

    /// From the first colour to the second by a sigmoid: from the middle outwards, or down a cube.
    fn gradient(&self, x: usize, y: usize) -> [u8; 3] {
        let [width, height] = self.size;
        let part = |at: usize, count: usize| 2.0 * at as f64 / (count.max(2) - 1) as f64 - 1.0;
        let (across, up) = (part(x, width), -part(y, height));
        let length = (1.0 + across * across + up * up).sqrt();
        let quarter = std::f64::consts::FRAC_PI_2;
        let [first, second] = self.texture.rgb;
        let (a, b, at) = match self.face {
            None => (
                second,
                first,
                2.0 * (across * across + up * up).sqrt() - 1.0,
            ),
            Some(2) => (first, second, 1.0 - libm::acos(1.0 / length) / quarter),
            Some(3) => (first, second, libm::acos(1.0 / length) / quarter - 1.0),
            Some(_) => (first, second, libm::asin(up / length) / quarter),
        };
        let share = 0.5 * (1.0 + at / (1.0 + at * at).sqrt() * std::f64::consts::SQRT_2);
        let share = share.clamp(0.0, 1.0);
        bytes([0, 1, 2].map(|k| share * a[k] + (1.0 - share) * b[k]))
    }
}
