//! Recordings of ale-py 0.12.1, where there are ROMs and recordings: `GYM_REFERENCE` names a folder of them.

use gym_atari::RomDir;
use gym_atari::games::by_md5;
use gym_atari::recording::Recording;

#[test]
fn games_are_ale_pys() {
    let (Some(reference), Some(roms)) = (std::env::var_os("GYM_REFERENCE"), RomDir::find()) else {
        println!("no games were compared: that needs GYM_REFERENCE and ROMs");
        return;
    };
    let mut compared = 0;
    for entry in std::fs::read_dir(reference).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let Ok(recorded) = serde_json::from_str::<Recording>(&text) else { continue };
        let Some(game) = by_md5(&recorded.md5) else { continue };
        let answers = recorded.replay(&roms.rom(game).unwrap()).unwrap();
        assert_eq!(recorded.first_difference(&answers), None, "{}", path.display());
        compared += 1;
    }
    println!("{compared} recordings of games were compared");
}
