//! The rules of environments, for every id.

gym_conform::suite!(gym_minigrid);
