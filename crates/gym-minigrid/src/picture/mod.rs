//! Frames, pixel for pixel as minigrid draws them: one tile for each cell.

mod shapes;
mod tile;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use gym_core::canvas::{Canvas, Color};

use crate::level::View;
use crate::{Cell, Facts, Pos, World};
use tile::{Patch, Scene};

/// The largest width and height of a frame.
const MAX_PIXELS: u32 = 16384;

/// The settings of an environment's frames, and a cache of drawn tiles.
#[derive(Debug)]
pub(crate) struct Picture {
    view: View,
    size: (u32, u32),
    tiles: Mutex<BTreeMap<Scene, Arc<[Patch]>>>,
}

impl Picture {
    pub(crate) fn new(Facts { view, rules }: &Facts) -> Result<Self, String> {
        let tile = view.tile_size;
        let (width, height) = if view.agent_pov {
            (view.agent_view_size, view.agent_view_size)
        } else {
            (rules.width, rules.height)
        };
        let most = MAX_PIXELS / width.max(height).max(1);
        if !(1..=most).contains(&tile) {
            return Err(format!(
                "tile_size is {tile}: from 1 to {most} pixels are possible for {width} by {height} cells"
            ));
        }
        Ok(Self {
            view: view.clone(),
            size: (width * tile, height * tile),
            tiles: Mutex::default(),
        })
    }

    /// Returns width and height in pixels.
    pub(crate) fn size(&self) -> (u32, u32) {
        self.size
    }

    pub(crate) fn draw(&self, world: &World, facts: &Facts, canvas: &mut dyn Canvas) {
        canvas.clear(Color::BLACK);
        self.each(world, facts, &mut |corner, Patch { place, color }| {
            let [x, y, width, height] = place.map(f64::from);
            let [r, g, b] = *color;
            let corner = corner.map(|n| n as f64);
            canvas.rect(
                [corner[0] + x, corner[1] + y],
                [width, height],
                Color::rgb(r, g, b),
            );
        });
    }

    /// Writes red, green and blue of every pixel, row by row.
    pub(crate) fn paint(&self, world: &World, facts: &Facts, pixels: &mut [u8]) {
        pixels.fill(0);
        let row_len = 3 * self.size.0 as usize;
        self.each(world, facts, &mut |corner, Patch { place, color }| {
            let [x, y, width, height] = place.map(usize::from);
            let (left, top) = (3 * (corner[0] + x), corner[1] + y);
            for row in pixels.chunks_exact_mut(row_len).skip(top).take(height) {
                row[left..left + 3 * width].as_chunks_mut().0.fill(*color);
            }
        });
    }

    /// Calls `f` with each patch of each tile, and the top left pixel of the tile.
    fn each(&self, world: &World, facts: &Facts, f: &mut dyn FnMut([usize; 2], &Patch)) {
        let size = self.view.agent_view_size as i32;
        let view = world.view(size);
        let visible = view.visible(&world.grid, facts.rules.see_through_walls);
        let square = || (0..size).flat_map(|j| (0..size).map(move |i| Pos::new(i, j)));
        let lit = |pos: Pos| visible[pos.y as usize] >> pos.x & 1 == 1;
        if self.view.agent_pov {
            let own = Pos::new(size / 2, size - 1);
            for pos in square() {
                let cell = match lit(pos) {
                    _ if pos == own => world.carrying,
                    true => world.grid.get(view.place(pos.x, pos.y)),
                    false => Cell::EMPTY,
                };
                self.tile(pos, cell, (pos == own).then_some(3), lit(pos), f);
            }
            return;
        }
        let width = world.grid.width();
        let mut seen = vec![false; world.grid.cells().len()];
        if self.view.highlight {
            let places = square()
                .filter(|pos| lit(*pos))
                .map(|pos| view.place(pos.x, pos.y));
            for Pos { x, y } in places.filter(|pos| world.grid.contains(*pos)) {
                seen[(y * width + x) as usize] = true;
            }
        }
        for (index, (cell, seen)) in world.grid.cells().iter().zip(seen).enumerate() {
            let pos = Pos::new(index as i32 % width, index as i32 / width);
            let agent = (pos == world.agent).then_some(world.direction);
            self.tile(pos, *cell, agent, seen, f);
        }
    }

    fn tile(
        &self,
        pos: Pos,
        cell: Cell,
        agent: Option<u8>,
        lit: bool,
        f: &mut dyn FnMut([usize; 2], &Patch),
    ) {
        let size = self.view.tile_size as usize;
        let scene = Scene::new(cell, agent, lit);
        let mut tiles = self.tiles.lock().unwrap_or_else(PoisonError::into_inner);
        let patches = tiles
            .entry(scene)
            .or_insert_with(|| scene.patches(cell, size).into());
        let corner = [pos.x, pos.y].map(|n| n as usize * size);
        patches.iter().for_each(|patch| f(corner, patch));
    }
}
