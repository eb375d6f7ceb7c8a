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

use gym_core::canvas::{Align, Canvas, Color, Label, Point, Segment, Shape, Transform};
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::spaces::TupleSpace;
use gym_core::{
    Dynamics, Generator, Keys, Policy, Registration, Reset, Result, Space, Stateful, Task,
    Transition,
};
use gym_native::{Many, Native, Whole};
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
        let State {
            dealer,
            player,
            suit,
            face,
        } = state;
        canvas.clear(FELT);
        let edge = Shape::Rect {
            min: [10.0, 10.0],
            size: [364.0, 356.0],
            corner: 16.0,
        };
        canvas.stroke(edge, 2.0, FELT_LINE);

        let open = dealer.cards()[0];
        canvas.text("DEALER", [32.0, 46.0], 12.0, Align::Left, Color::WHITE);
        card(canvas, [32.0, 58.0], open, *face, *suit);
        back(canvas, [124.0, 58.0]);
        canvas.text(
            &Label::new(format_args!("{open}")),
            [296.0, 134.0],
            40.0,
            Align::Center,
            Color::WHITE,
        );

        canvas.text("PLAYER", [32.0, 210.0], 12.0, Align::Left, Color::WHITE);
        let hidden = player.cards().len() - 1;
        let shift = (92.0 / hidden as f64).min(23.0);
        for (i, value) in player.cards().iter().enumerate() {
            // Gymnasium does not choose their suits, so any suit will do
            let suit = SUITS[(*suit as usize + 1 + i) % SUITS.len()];
            card(canvas, [32.0 + shift * i as f64, 222.0], *value, None, suit);
        }
        canvas.text(
            &Label::new(format_args!("{}", player.sum())),
            [296.0, 298.0],
            40.0,
            Align::Center,
            Color::WHITE,
        );
        let note = match (player.is_bust(), player.usable_ace()) {
            (true, _) => "bust",
            (_, true) => "usable ace",
            _ => "",
        };
        canvas.text(note, [296.0, 326.0], 12.0, Align::Center, Color::WHITE);
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

const FELT: Color = Color::rgb(36, 110, 76);
const FELT_LINE: Color = Color::rgb(88, 152, 116);
const CARD: [f64; 2] = [80.0, 112.0];
const RED: Color = Color::rgb(204, 52, 56);
const BLACK: Color = Color::rgb(38, 40, 52);
const BACK: Color = Color::rgb(56, 84, 150);

/// Draws an open card.
fn card(canvas: &mut dyn Canvas, corner: Point, value: u8, face: Option<Face>, suit: Suit) {
    let color = if matches!(suit, Suit::Hearts | Suit::Diamonds) {
        RED
    } else {
        BLACK
    };
    let rank = match (value, face) {
        (1, _) => Label::new(format_args!("A")),
        (_, Some(Face::Jack)) => Label::new(format_args!("J")),
        (_, Some(Face::Queen)) => Label::new(format_args!("Q")),
        (_, Some(Face::King)) => Label::new(format_args!("K")),
        _ => Label::new(format_args!("{value}")),
    };
    blank(canvas, corner);
    canvas.push(Transform::translate(corner[0], corner[1]));
    canvas.text(&rank, [11.0, 19.0], 11.0, Align::Center, color);
    pip(canvas, suit, [11.0, 30.0], 10.0, color);
    if face.is_some() {
        canvas.text(&rank, [44.0, 76.0], 40.0, Align::Center, color);
        pip(canvas, suit, [66.0, 96.0], 14.0, color);
    } else if value == 1 {
        pip(canvas, suit, [46.0, 56.0], 36.0, color);
    } else {
        let (outer, middle) = pips(value);
        for (x, column) in [(31.0, outer), (46.0, middle), (61.0, outer)] {
            for &y in column {
                // pips below the middle are upside down
                let height = if y > 0.5 { -15.0 } else { 15.0 };
                pip(canvas, suit, [x, 20.0 + 72.0 * y], height, color);
            }
        }
    }
    canvas.pop();
}

/// Returns the vertical positions, from 0 to 1, of a number card's pips: in both outer columns, and
/// in the middle.
fn pips(value: u8) -> (&'static [f64], &'static [f64]) {
    match value {
        2 => (&[], &[0.0, 1.0]),
        3 => (&[], &[0.0, 0.5, 1.0]),
        4 => (&[0.0, 1.0], &[]),
        5 => (&[0.0, 1.0], &[0.5]),
        6 => (&[0.0, 0.5, 1.0], &[]),
        7 => (&[0.0, 0.5, 1.0], &[0.25]),
        8 => (&[0.0, 0.5, 1.0], &[0.25, 0.75]),
        9 => (&[0.0, 0.33, 0.67, 1.0], &[0.5]),
        10 => (&[0.0, 0.33, 0.67, 1.0], &[0.17, 0.83]),
        _ => (&[], &[]),
    }
}

/// Draws a suit's symbol; with a negative `height` upside down.
fn pip(canvas: &mut dyn Canvas, suit: Suit, center: Point, height: f64, color: Color) {
    let half = height / 2.0;
    canvas.push(Transform {
        x: [half, 0.0],
        y: [0.0, half],
        origin: center,
    });
    match suit {
        Suit::Diamonds => {
            canvas.polygon(&[[0.0, -1.0], [0.75, 0.0], [0.0, 1.0], [-0.75, 0.0]], color);
        }
        Suit::Hearts => heart(canvas, color),
        Suit::Spades => {
            canvas.push(Transform {
                x: [1.0, 0.0],
                y: [0.0, -0.8],
                origin: [0.0, -0.2],
            });
            heart(canvas, color);
            canvas.pop();
            stem(canvas, color);
        }
        Suit::Clubs => {
            for center in [[0.0, -0.5], [-0.5, 0.2], [0.5, 0.2]] {
                canvas.circle(center, 0.48, color);
            }
            canvas.polygon(&[[0.0, -0.4], [0.4, 0.3], [-0.4, 0.3]], color);
            stem(canvas, color);
        }
    }
    canvas.pop();
}

fn heart(canvas: &mut dyn Canvas, color: Color) {
    let outline = [
        Segment::Move([0.0, 1.0]),
        Segment::Cubic([-0.4, 0.5], [-0.9, 0.2], [-0.9, -0.35]),
        Segment::Cubic([-0.9, -1.05], [-0.15, -1.15], [0.0, -0.5]),
        Segment::Cubic([0.15, -1.15], [0.9, -1.05], [0.9, -0.35]),
        Segment::Cubic([0.9, 0.2], [0.4, 0.5], [0.0, 1.0]),
        Segment::Close,
    ];
    canvas.fill(Shape::Path(&outline), color);
}

fn stem(canvas: &mut dyn Canvas, color: Color) {
    let outline = [
        Segment::Move([0.0, 0.1]),
        Segment::Quad([0.05, 0.8], [0.45, 1.0]),
        Segment::Line([-0.45, 1.0]),
        Segment::Quad([-0.05, 0.8], [0.0, 0.1]),
        Segment::Close,
    ];
    canvas.fill(Shape::Path(&outline), color);
}

/// Draws a card, face down.
fn back(canvas: &mut dyn Canvas, corner: Point) {
    blank(canvas, corner);
    let [x, y] = corner;
    canvas.round_rect(
        [x + 6.0, y + 6.0],
        [CARD[0] - 12.0, CARD[1] - 12.0],
        4.0,
        BACK,
    );
    for row in 0..6 {
        for col in 0..4 {
            let center = [
                x + 16.0 + 16.0 * f64::from(col),
                y + 16.0 + 16.0 * f64::from(row),
            ];
            pip(canvas, Suit::Diamonds, center, 12.0, Color::WHITE);
        }
    }
}

fn blank(canvas: &mut dyn Canvas, corner: Point) {
    canvas.round_rect(
        [corner[0] - 1.0, corner[1] - 1.0],
        [CARD[0] + 2.0, CARD[1] + 2.0],
        8.0,
        FELT_LINE,
    );
    canvas.round_rect(corner, CARD, 7.0, Color::WHITE);
}

impl Native for BlackjackDynamics {
    type Packed = Whole<State>;
    type Stream = Generator;
    type Constants = [f64; 0];

    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> Whole<State> {
        Whole(*state)
    }

    #[inline(always)]
    fn unpack(&self, Whole(state): Whole<State>, _fresh: bool) -> State {
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
