//! Blackjack: come closer to 21 than the dealer without going over it.
//!
//! | | |
//! |---|---|
//! | observation | (the player's sum, the dealer's open card: 1 (ace) to 10, 1 if the player has a usable ace); `Tuple(Discrete(32), Discrete(11), Discrete(2))` |
//! | action | [`Action`]: stick or hit; `Discrete(2)` |
//! | dynamics | cards come from an endless deck; jack, queen and king count 10; an ace counts 11 while that does not go over 21 (it is then *usable*), else 1; after the player sticks, the dealer draws up to 17 or more |
//! | reward | 1 for a win, -1 for a loss, 0 for a draw; see [`Config::natural`] and [`Config::sab`] for naturals, an ace and a ten at once |
//! | start | two cards each |
//! | end | terminated when the player sticks or goes over 21 |
//! | limit | none |
//!
//! Versions: v1 corrected the value of a natural.
//!
//! After Example 5.1 of Sutton and Barto, *Reinforcement Learning: An Introduction* (2020). Source:
//! Gymnasium 1.4.0, `envs/toy_text/blackjack.py`.

mod draw;

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::spaces::TupleSpace;
use gym_core::{
    Dynamics, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful, Task,
    Transition,
};
use gym_native::{Many, Native, Unpacked};
use serde::{Deserialize, Serialize};

/// The environment.
pub type Blackjack = Stateful<BlackjackDynamics>;

gym_core::arguments! {
    /// Arguments. A natural is an ace and a ten as the first two cards.
    #[derive(Copy)]
    pub struct Config {
        /// Whether a win with a natural earns 1.5. Without effect if `sab` is set.
        pub natural: bool,
        /// Whether a natural beats every hand except another natural, as in Sutton and Barto's
        /// book. `Blackjack-v1` is registered with this set.
        pub sab: bool,
    }
}

const DECK: [u8; 13] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10];

gym_core::discrete! {
    /// An action of the player.
    pub enum Action {
        /// Takes no more cards.
        Stick,
        /// Takes a card.
        Hit,
    }
}

/// Cards by value, 1 (an ace) to 10: at least two; all except the last sum to at most 21.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<u8>", into = "Vec<u8>")]
pub struct Hand {
    cards: [u8; Self::MAX_LEN],
    len: u8,
    /// The sum of the cards with every ace as 1.
    hard_sum: u8,
    has_ace: bool,
}

impl Hand {
    /// 21 aces, and the card that exceeds 21.
    const MAX_LEN: usize = 22;
    const EMPTY: Self = Self {
        cards: [0; Self::MAX_LEN],
        len: 0,
        hard_sum: 0,
        has_ace: false,
    };

    fn draw(rng: &mut Generator) -> Self {
        let mut hand = Self::EMPTY;
        hand.draw_card(rng);
        hand.draw_card(rng);
        hand
    }

    #[inline]
    fn draw_card(&mut self, rng: &mut Generator) {
        self.push(DECK[rng.choice(DECK.len())]);
    }

    #[inline]
    fn push(&mut self, card: u8) {
        if let Some(place) = self.cards.get_mut(usize::from(self.len)) {
            *place = card;
            self.len += 1;
            self.hard_sum += card;
            self.has_ace |= card == 1;
        }
    }

    /// Returns the cards in the order drawn.
    pub fn cards(&self) -> &[u8] {
        &self.cards[..usize::from(self.len)]
    }

    /// Whether an ace counts 11.
    pub fn usable_ace(&self) -> bool {
        self.has_ace && self.hard_sum + 10 <= 21
    }

    /// Returns the sum; a usable ace counts 11.
    pub fn sum(&self) -> u8 {
        self.hard_sum + if self.usable_ace() { 10 } else { 0 }
    }

    /// Whether the sum is over 21.
    pub fn is_bust(&self) -> bool {
        self.sum() > 21
    }

    /// Returns the sum, or 0 if the hand is bust.
    fn score(&self) -> u8 {
        if self.is_bust() { 0 } else { self.sum() }
    }

    /// Whether the hand is an ace and a ten.
    pub fn is_natural(&self) -> bool {
        matches!(self.cards(), [1, 10] | [10, 1])
    }
}

impl From<Hand> for Vec<u8> {
    fn from(hand: Hand) -> Self {
        hand.cards().to_vec()
    }
}

impl TryFrom<Vec<u8>> for Hand {
    type Error = String;

    fn try_from(cards: Vec<u8>) -> Result<Self, String> {
        let possible = cards.len() >= 2
            && cards.iter().all(|card| (1..=10).contains(card))
            && cards[..cards.len() - 1]
                .iter()
                .map(|card| usize::from(*card))
                .sum::<usize>()
                <= 21;
        if !possible {
            return Err(format!("{cards:?} is not a hand of blackjack"));
        }
        let mut hand = Self::EMPTY;
        cards.into_iter().for_each(|card| hand.push(card));
        Ok(hand)
    }
}

/// The suit of the dealer's open card, for its drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Suit {
    Clubs,
    Diamonds,
    Hearts,
    Spades,
}

const SUITS: [Suit; 4] = [Suit::Clubs, Suit::Diamonds, Suit::Hearts, Suit::Spades];

/// The face of a dealer's open card of value 10, for its drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Face {
    Jack,
    Queen,
    King,
}

/// The cards on the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The dealer's cards; the first is open.
    pub dealer: Hand,
    /// The player's cards.
    pub player: Hand,
    /// The suit of the dealer's open card.
    pub suit: Suit,
    /// The face on the dealer's open card, if its value is 10.
    #[serde(deserialize_with = "Option::deserialize")]
    pub face: Option<Face>,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct BlackjackDynamics {
    config: Config,
}

impl BlackjackDynamics {
    /// Takes a step.
    #[inline(always)]
    fn play(&self, state: &State, action: Action, rng: &mut Generator) -> Transition<State> {
        let mut state = *state;
        if action == Action::Hit {
            // a step after the end of an episode draws no card
            if !state.player.is_bust() {
                state.player.draw_card(rng);
            }
            let terminated = state.player.is_bust();
            return Transition {
                state,
                reward: if terminated { -1.0 } else { 0.0 },
                terminated,
            };
        }
        while state.dealer.sum() < 17 {
            state.dealer.draw_card(rng);
        }
        let State { dealer, player, .. } = &state;
        let reward = f64::from(player.score().cmp(&dealer.score()) as i8);
        let reward = match self.config {
            Config { sab: true, .. } if player.is_natural() && !dealer.is_natural() => 1.0,
            Config {
                sab: false,
                natural: true,
            } if player.is_natural() && reward == 1.0 => 1.5,
            _ => reward,
        };
        Transition {
            state,
            reward,
            terminated: true,
        }
    }
}

impl Task for BlackjackDynamics {
    type Config = Config;
    type State = State;
    type Observation = (usize, usize, usize);
    type Action = Action;

    const NAME: &'static str = "Blackjack";

    fn new(config: Config) -> Result<Self> {
        Ok(Self { config })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        TupleSpace::new([32, 11, 2].map(Space::discrete)).into()
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        let dealer = Hand::draw(rng);
        let player = Hand::draw(rng);
        // the suit and face use random numbers, as in Gymnasium
        let suit = SUITS[rng.choice(SUITS.len())];
        let face =
            (dealer.cards()[0] == 10).then(|| [Face::Jack, Face::Queen, Face::King][rng.choice(3)]);
        Ok(State {
            dealer,
            player,
            suit,
            face,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        state.face.is_some() == (state.dealer.cards()[0] == 10)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(4, (384, 376))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        draw::table(state, canvas);
    }
}

impl Dynamics for BlackjackDynamics {
    fn transition(
        &self,
        state: &State,
        action: &Action,
        rng: &mut Generator,
    ) -> Result<Transition<State>> {
        Ok(self.play(state, *action, rng))
    }

    fn observe(&self, state: &State) -> (usize, usize, usize) {
        let State { dealer, player, .. } = state;
        (
            player.sum().into(),
            dealer.cards()[0].into(),
            player.usable_ace().into(),
        )
    }
}

impl Native for BlackjackDynamics {
    type Packed = Unpacked<State>;
    type Stream = Generator;
    type Constants = [f64; 0];

    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> Unpacked<State> {
        Unpacked(*state)
    }

    #[inline(always)]
    fn unpack(&self, Unpacked(state): Unpacked<State>, _fresh: bool) -> State {
        state
    }

    #[inline(always)]
    fn step_block<R: Real>(&self, _: R::Token, block: &mut Many<'_, Self>) {
        block.each(self, |state, action, rng| self.play(state, action, rng));
    }
}

/// Basic strategy: Sutton and Barto, figure 5.2.
fn basic_strategy((sum, dealer, usable_ace): &(i64, i64, i64)) -> i64 {
    let stick = if *usable_ace == 1 {
        *sum >= if *dealer >= 9 { 19 } else { 18 }
    } else {
        let least = match *dealer {
            2..=3 => 13,
            4..=6 => 12,
            _ => 17,
        };
        *sum >= least
    };
    i64::from(!stick)
}

#[cfg(not(test))]
gym_core::register!(
    Registration::new::<Blackjack>("Blackjack-v1")
        .description("Beat the dealer's hand without going above 21.")
        .kwargs(r#"{"sab": true, "natural": false}"#)
        .vector_entry_point(gym_native::entry_point::<BlackjackDynamics>)
        .light_step()
        .names(|_| Names::new(
            &[
                "the player's sum",
                "the dealer's open card",
                "1 if the player has a usable ace, else 0"
            ],
            &[]
        ))
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"S": 0, "Down": 0, "H": 1, "Up": 1})))
        .policy(Policy::rules(
            "is the basic strategy of Sutton and Barto's figure 5.2",
            |_| reflex(basic_strategy)
        ))
        .clip(Clip {
            seeds: 0..12,
            every: 1,
            frames: 24,
            size: (192, 188)
        }),
);

#[cfg(test)]
mod tests {
    use gym_core::{EnvExt, Snapshot};

    use super::*;

    fn hand(cards: &[u8]) -> Hand {
        Hand::try_from(cards.to_vec()).unwrap()
    }

    /// The cards that Gymnasium deals for these seeds.
    #[test]
    fn the_deal_is_gymnasiums() {
        for (seed, dealer, player, suit, face) in [
            (0, [10, 9], [7, 4], Suit::Diamonds, Some(Face::Jack)),
            (42, [2, 10], [9, 6], Suit::Diamonds, None),
            (123, [1, 9], [8, 1], Suit::Spades, None),
        ] {
            let mut env = Blackjack::new(Config::default()).unwrap();
            env.reset(seed).unwrap();
            let state = State {
                dealer: hand(&dealer),
                player: hand(&player),
                suit,
                face,
            };
            assert_eq!(env.state(), Some(&state));
        }
    }

    #[test]
    fn an_ace_counts_11_while_it_can() {
        for (cards, sum, usable) in [
            (&[1, 1][..], 12, true),
            (&[1, 10], 21, true),
            (&[1, 5, 5], 21, true),
            (&[1, 5, 6], 12, false),
            (&[10, 10, 1], 21, false),
            (&[10, 10, 2], 22, false),
            (&[1, 2, 3, 4, 5], 15, false),
            (&[1, 2, 1, 1, 3], 18, true),
        ] {
            assert_eq!(
                (hand(cards).sum(), hand(cards).usable_ace()),
                (sum, usable),
                "{cards:?}"
            );
        }
    }

    /// Returns the reward of the action stick with the hand `player`, against a dealer who draws no
    /// more cards.
    fn reward(config: Config, player: &[u8], dealer: &[u8]) -> f64 {
        let state = State {
            dealer: hand(dealer),
            player: hand(player),
            suit: Suit::Clubs,
            face: Some(Face::King),
        };
        let blackjack = BlackjackDynamics::new(config).unwrap();
        blackjack
            .transition(&state, &Action::Stick, &mut Generator::from(0))
            .unwrap()
            .reward
    }

    #[test]
    fn naturals_pay_by_the_rules_chosen() {
        let plain = Config::default();
        let natural = Config {
            natural: true,
            ..plain
        };
        let sab = Config {
            natural: true,
            sab: true,
        };
        for (player, dealer, rewards) in [
            (&[10, 1], &[10, 9][..], [1.0, 1.5, 1.0]),
            (&[10, 1], &[10, 5, 6], [0.0, 0.0, 1.0]),
            (&[10, 1], &[10, 1], [0.0, 0.0, 0.0]),
            (&[10, 9], &[10, 1], [-1.0, -1.0, -1.0]),
            (&[10, 9], &[10, 6, 10], [1.0, 1.0, 1.0]),
        ] {
            assert_eq!(
                [plain, natural, sab].map(|config| reward(config, player, dealer)),
                rewards
            );
        }
    }

    #[test]
    fn hits_after_a_bust_take_no_card() {
        let blackjack = BlackjackDynamics::new(Config::default()).unwrap();
        let rng = &mut Generator::from(0);
        let mut state = blackjack.start(&Reset::default(), rng).unwrap();
        while !state.player.is_bust() {
            state = blackjack
                .transition(&state, &Action::Hit, rng)
                .unwrap()
                .state;
        }
        let again = blackjack.transition(&state, &Action::Hit, rng).unwrap();
        assert_eq!(
            (again.state, again.reward, again.terminated),
            (state, -1.0, true)
        );
    }

    #[test]
    fn a_stored_hand_must_be_possible() {
        let longest = hand(&[1; Hand::MAX_LEN]);
        assert_eq!(
            Snapshot::of(&longest).unwrap().get::<Hand>().unwrap(),
            longest
        );
        for cards in [
            &[][..],
            &[5],
            &[0, 5],
            &[11, 5],
            &[10, 10, 2, 1],
            &[1; Hand::MAX_LEN + 1],
        ] {
            assert!(Hand::try_from(cards.to_vec()).is_err(), "{cards:?}");
        }
    }
}
