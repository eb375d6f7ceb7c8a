//! Textures, and the materials that have them.

use std::path::PathBuf;

use super::{replace, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::TextureType;

/// A pattern that needs no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pattern {
    Gradient,
    Checker,
    Flat,
}

/// Lines on a pattern.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mark {
    #[default]
    None,
    Edge,
    Cross,
}

/// Where the pixels of a texture come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Pixels {
    Pattern(Pattern),
    /// One file: of a cube, with a face for each letter of `layout`.
    File(PathBuf),
    /// A file for each face of a cube: right, left, up, down, front, back.
    Faces([Option<PathBuf>; 6]),
}

/// A texture, before its files are read.
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    pub(crate) place: Place,
    pub(crate) name: String,
    pub(crate) kind: TextureType,
    pub(crate) pixels: Pixels,
    pub(crate) rgb: [[f64; 3]; 2],
    pub(crate) mark: Mark,
    pub(crate) mark_rgb: [f64; 3],
    pub(crate) size: [usize; 2],
    pub(crate) channels: usize,
    /// The rows and columns of a cube's faces in its file, and the letters of the faces.
    pub(crate) grid: [usize; 2],
    pub(crate) layout: Vec<u8>,
    /// Whether to turn files left to right, and upside down.
    pub(crate) flip: [bool; 2],
}

const FACES: [&str; 6] = [
    "fileright",
    "fileleft",
    "fileup",
    "filedown",
    "filefront",
    "fileback",
];

impl Texture {
    /// Reads a texture whose files are in `folder` beside the model.
    pub(crate) fn read(mut element: Element<'_, '_>, folder: &str, strip: bool) -> Result<Self> {
        let place = element.place();
        let file = element.text("file")?;
        let bare = |file: &str| {
            file.rsplit(['/', '\\'])
                .next()
                .unwrap_or_default()
                .to_owned()
        };
        let stem = file.as_deref().map(|file| {
            let name = bare(file);
            name.rsplit_once('.')
                .map_or(name.clone(), |(stem, _)| stem.to_owned())
        });
        let name = element.text("name")?.or(stem).unwrap_or_default();
        let kinds = [
            ("2d", TextureType::Flat),
            ("cube", TextureType::Cube),
            ("skybox", TextureType::Skybox),
        ];
        let kind = element
            .keyword("type", &kinds)?
            .unwrap_or(TextureType::Cube);
        let patterns = [
            ("none", None),
            ("gradient", Some(Pattern::Gradient)),
            ("checker", Some(Pattern::Checker)),
            ("flat", Some(Pattern::Flat)),
        ];
        let pattern = element.keyword("builtin", &patterns)?.flatten();
        element.keyword("content_type", &[("image/png", ())])?;
        let find = |element: &Element<'_, '_>, attribute: &str, file: &str| match strip {
            true => element.find(attribute, folder, &bare(file)),
            false => element.find(attribute, folder, file),
        };
        let mut faces: [Option<PathBuf>; 6] = Default::default();
        for (path, attribute) in faces.iter_mut().zip(FACES) {
            if let Some(file) = element.text(attribute)? {
                *path = Some(find(&element, attribute, &file)?);
            }
        }
        let pixels = match (pattern, file) {
            (Some(pattern), _) => Pixels::Pattern(pattern),
            (None, Some(file)) => Pixels::File(find(&element, "file", &file)?),
            (None, None) if kind == TextureType::Flat || faces.iter().all(Option::is_none) => {
                let reason = "missing: give a file, the files of faces, or a builtin pattern";
                return Err(place.attribute("file", reason));
            }
            (None, None) => Pixels::Faces(faces),
        };
        let mut texture = Self {
            place,
            name,
            kind,
            pixels,
            rgb: [[0.8; 3], [0.5; 3]],
            mark: Mark::None,
            mark_rgb: [0.0; 3],
            size: [0; 2],
            channels: 3,
            grid: [1; 2],
            layout: vec![b'.'; 12],
            flip: [false; 2],
        };
        texture.read_rest(&mut element)?;
        element.finish_without_children()?;
        Ok(texture)
    }

    fn read_rest(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        replace(&mut self.rgb[0], element.numbers("rgb1")?);
        replace(&mut self.rgb[1], element.numbers("rgb2")?);
        // random dots are not drawn
        let marks = [
            ("none", Mark::None),
            ("edge", Mark::Edge),
            ("cross", Mark::Cross),
            ("random", Mark::None),
        ];
        element.set_keyword("mark", &marks, &mut self.mark)?;
        replace(&mut self.mark_rgb, element.numbers("markrgb")?);
        element.ignore("random colorspace");
        for (length, name) in self.size.iter_mut().zip(["width", "height"]) {
            replace(length, element.integer::<u32>(name)?.map(|n| n as usize));
        }
        let channels = element.integer::<u32>("nchannel")?;
        replace(&mut self.channels, channels.map(|n| n as usize));
        if ![1, 3, 4].contains(&self.channels) {
            return Err(self.place.attribute("nchannel", "must be 1, 3 or 4"));
        }
        for (flip, name) in self.flip.iter_mut().zip(["hflip", "vflip"]) {
            replace(flip, element.flag(name)?);
        }
        if let Some([rows, columns]) = element.numbers("gridsize")? {
            self.grid = [rows as usize, columns as usize];
            if !(1..=12).contains(&self.grid[0].saturating_mul(self.grid[1])) {
                return Err(self.place.attribute("gridsize", "needs 1 to 12 faces"));
            }
        }
        if let Some(layout) = element.text("gridlayout")? {
            if let Some(other) = layout.chars().find(|c| !".RLUDFB".contains(*c)) {
                let reason = format!("{other:?} is no face: use the letters .RLUDFB");
                return Err(self.place.attribute("gridlayout", reason));
            }
            self.layout = layout.into_bytes();
            self.layout.resize(12, b'.');
        }
        Ok(())
    }
}

with_defaults! {
    /// The look of a geom.
    struct Material {
        place: Place = Place::default(),
        name: String = String::new(),
        rgba: [f64; 4] = [1.0; 4],
        texture: Option<String> = None,
        repeat: [f64; 2] = [1.0; 2],
        uniform: bool = false,
        emission: f64 = 0.0,
        specular: f64 = 0.5,
        shininess: f64 = 0.5,
    }
}

impl Material {
    /// Reads what pictures show, and ignores other attributes.
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        replace(&mut self.rgba, element.numbers("rgba")?);
        replace_some(&mut self.texture, element.text("texture")?);
        replace(&mut self.repeat, element.numbers("texrepeat")?);
        replace(&mut self.uniform, element.flag("texuniform")?);
        for (name, value) in [
            ("emission", &mut self.emission),
            ("specular", &mut self.specular),
            ("shininess", &mut self.shininess),
        ] {
            replace(value, element.number(name)?);
        }
        element.ignore("reflectance metallic roughness");
        for mut layer in element.children()? {
            if layer.name() != "layer" {
                return Err(element.unsupported(&layer, &["layer"]));
            }
            let texture = layer.required_text("texture")?;
            if ["rgb", "rgba"].contains(&&*layer.required_text("role")?) {
                self.texture = Some(texture);
            }
            layer.finish_without_children()?;
        }
        Ok(())
    }
}
