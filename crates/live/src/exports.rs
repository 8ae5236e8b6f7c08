//! The functions of the page, as WebAssembly has them. There is one player.
//!
//! The page writes bytes or numbers where [`room`] says, calls a function, and reads results at the places that the others give.
//! A function that can fail returns 0 where it has done its work; otherwise its message is at [`message`].
#![allow(unsafe_code)] // names that the page knows, which the compiler must leave as they are

use std::cell::RefCell;

use dynamics::nalgebra::Vector3;

use crate::change::Change;
use crate::error::LiveError;
use crate::player::Player;
use crate::run::LiveRun;

/// Everything that stays from call to call.
struct Page {
    player: Option<Player>,
    /// Given by the page: eight bytes a word.
    given: Vec<u64>,
    message: String,
}

thread_local! {
    static PAGE: RefCell<Page> = const { RefCell::new(Page { player: None, given: Vec::new(), message: String::new() }) };
}

fn of_page<T>(work: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(work)
}

/// Does something with the player, and keeps the message of its error.
fn with_player(work: impl FnOnce(&mut Player, &[f64]) -> Result<(), LiveError>) -> u32 {
    of_page(|page| {
        let given: Vec<f64> = page.given.iter().map(|word| f64::from_bits(*word)).collect();
        let done = match &mut page.player {
            Some(player) => work(player, &given),
            None => Err(LiveError::Nothing { what: "motion yet" }),
        };
        told(&mut page.message, done)
    })
}

fn told(message: &mut String, done: Result<(), LiveError>) -> u32 {
    *message = done.as_ref().err().map_or_else(String::new, ToString::to_string);
    u32::from(done.is_err())
}

/// Room for `bytes` bytes from the page, at a multiple of eight.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u64 {
    of_page(|page| {
        page.given.clear();
        page.given.resize(bytes.div_ceil(8), 0);
        page.given.as_mut_ptr()
    })
}

/// Begins the run whose data have been given, of `bytes` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn begin(bytes: usize, frame: f64) -> u32 {
    of_page(|page| {
        let words = page.given.iter().flat_map(|word| word.to_le_bytes());
        let begun =
            LiveRun::from_bytes(&words.take(bytes).collect::<Vec<u8>>()).and_then(|run| Player::new(run, frame));
        let begun = begun.map(|player| page.player = Some(player));
        page.given = Vec::new();
        told(&mut page.message, begun)
    })
}

/// Goes back to the beginning, with nothing changed.
#[unsafe(no_mangle)]
pub extern "C" fn restart() -> u32 {
    with_player(|player, _| player.restart())
}

/// Leads all motions to a time.
#[unsafe(no_mangle)]
pub extern "C" fn lead_to(time: f64) -> u32 {
    with_player(|player, _| player.lead_to(time))
}

/// Changes something: see [`Change::by_number`].
#[unsafe(no_mangle)]
pub extern "C" fn change(kind: u32, of: usize, item: usize, value: f64) -> u32 {
    with_player(|player, _| {
        let change = Change::by_number(kind, of, item).ok_or(LiveError::Nothing { what: "change of this kind" })?;
        player.set(change, value)
    })
}

/// Sets the magnitude of a body's angular velocity.
#[unsafe(no_mangle)]
pub extern "C" fn spin(body: usize, spin: f64) -> u32 {
    with_player(|player, _| player.set_spin(body, spin))
}

/// Begins to pull at a body. Given are the place on it (3), the place to pull to (3), stiffness and damping, and the shapes at the
/// place, three numbers for each coordinate.
#[unsafe(no_mangle)]
pub extern "C" fn pull(body: usize) -> u32 {
    with_player(|player, given| match given {
        [x, y, z, to_x, to_y, to_z, stiffness, damping, shapes @ ..] => {
            let [place, target] = [Vector3::new(*x, *y, *z), Vector3::new(*to_x, *to_y, *to_z)];
            player.pull(body, place, shapes, [*stiffness, *damping], target)
        }
        _ => Err(LiveError::Nothing { what: "place to pull at" }),
    })
}

/// Moves the place that is pulled to.
#[unsafe(no_mangle)]
pub extern "C" fn move_pull(x: f64, y: f64, z: f64) -> u32 {
    with_player(|player, _| player.move_pull(Vector3::new(x, y, z)))
}

/// Ends the pull.
#[unsafe(no_mangle)]
pub extern "C" fn let_go() -> u32 {
    with_player(|player, _| player.let_go())
}

/// Where the numbers of the state are: see [`Player::numbers`].
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f64 {
    of_page(|page| page.player.as_ref().map_or(std::ptr::null(), |player| player.numbers().as_ptr()))
}

/// How many they are.
#[unsafe(no_mangle)]
pub extern "C" fn number_count() -> usize {
    of_page(|page| page.player.as_ref().map_or(0, |player| player.numbers().len()))
}

/// Number of bodies.
#[unsafe(no_mangle)]
pub extern "C" fn bodies() -> usize {
    of_page(|page| page.player.as_ref().map_or(0, Player::bodies))
}

/// Number of coordinates of a body's shapes.
#[unsafe(no_mangle)]
pub extern "C" fn coordinates(body: usize) -> usize {
    of_page(|page| page.player.as_ref().map_or(0, |player| player.coordinates(body)))
}

/// 1 as long as nothing was changed.
#[unsafe(no_mangle)]
pub extern "C" fn is_recorded() -> u32 {
    of_page(|page| page.player.as_ref().map_or(0, |player| u32::from(player.is_recorded())))
}

/// Steps taken since the motions began, or were changed.
#[unsafe(no_mangle)]
pub extern "C" fn steps() -> f64 {
    of_page(|page| page.player.as_ref().map_or(0.0, |player| player.steps() as f64))
}

/// Where the message of the last function that failed is.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    of_page(|page| page.message.as_ptr())
}

/// How many bytes it has.
#[unsafe(no_mangle)]
pub extern "C" fn message_length() -> usize {
    of_page(|page| page.message.len())
}
