//! Which part of a log flew, and which of it is taken.

use std::fmt;

use super::error::Fault;
use super::recording::Recording;
use super::track::{SECOND_NS, Span, Track, seconds};

/// The part of a log that is asked for; times are s from its first gyroscope sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Part {
    /// The longest airborne part; all of a log in which none is seen.
    #[default]
    Longest,
    /// An airborne part by its number, from 1.
    Number(usize),
    /// A span; an end that is not given is the log's.
    Between(Option<f64>, Option<f64>),
}

/// What shows when a drone was airborne.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// The log says when it landed.
    Landed,
    /// The motor commands.
    Motors,
    /// Nothing does.
    Nothing,
}

/// Why a part of a log is the one that is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PartReason {
    /// It is the longest that was airborne.
    LongestAirborne,
    /// It was asked for.
    AsAskedFor,
    /// Nothing in the log shows when it flew: all of it.
    NothingShowsFlight,
    /// The log shows that it never flew: all of it.
    NeverAirborne,
}

impl fmt::Display for PartReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LongestAirborne => "the longest airborne part",
            Self::AsAskedFor => "as asked for",
            Self::NothingShowsFlight => "all of it, nothing shows when it flew",
            Self::NeverAirborne => "all of it, though it never flew",
        })
    }
}

/// The part that was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Taken {
    /// Which, in times of the log.
    #[serde(flatten)]
    pub span: Span,
    /// Why it.
    pub reason: PartReason,
}

/// When a drone flew.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Flown {
    /// Each airborne part.
    pub parts: Vec<Span>,
    /// What shows it.
    pub evidence: Evidence,
}

/// Dips and landings shorter than this belong to the flight around them: dives, touch and go.
const BRIDGED_NS: i64 = 5 * SECOND_NS;
/// Shorter hops are no flights.
const SHORTEST_NS: i64 = 2 * SECOND_NS;
/// Below this mean share of full scale no drone flies.
const IDLE: f64 = 0.05;
/// Motors that turn at this part of their usual command carry a drone no more.
const CARRIES: f64 = 0.4;

impl Flown {
    /// Finds the airborne parts of a recording.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let Some(whole) = recording.span() else {
            return Self::none(Evidence::Nothing);
        };
        let motors = recording.motors.as_ref().map(|motors| motors.mean());
        let motors = motors.filter(|mean| mean.values().iter().any(|[share]| *share > IDLE));
        let landed = recording.landed.as_ref().filter(|track| !track.is_empty());
        let mut parts = vec![whole];
        let evidence = match (landed, &motors) {
            (None, None) => return Self::none(Evidence::Nothing),
            (None, Some(mean)) => {
                parts = within(&parts, &joined(&spans(&carried(mean), whole)));
                Evidence::Motors
            }
            (Some(landed), motors) => {
                let airborne = landed.map(|[state]| [1.0 - state]);
                parts = within(&parts, &joined(&spans(&airborne, whole)));
                // A wreck does not land.
                if let Some(mean) = motors {
                    let turning = mean.map(|[share]| [f64::from(u8::from(share > IDLE))]);
                    parts = within(&parts, &joined(&spans(&turning, whole)));
                }
                Evidence::Landed
            }
        };
        if let Some(armed) = &recording.armed {
            parts = within(&parts, &spans(armed, whole));
        }
        parts.retain(|part| part.length_ns() >= SHORTEST_NS);
        Self { parts, evidence }
    }

    fn none(evidence: Evidence) -> Self {
        let parts = Vec::new();
        Self { parts, evidence }
    }

    /// The longest airborne part, the first of several.
    fn longest(&self) -> Option<Span> {
        let parts = self.parts.iter().copied();
        parts.reduce(|best, part| {
            if part.length_ns() > best.length_ns() {
                part
            } else {
                best
            }
        })
    }
}

/// 1 while motors carry the drone, else 0.
fn carried(mean: &Track<1>) -> Track<1> {
    let mut turning: Vec<f64> = mean.values().iter().map(|[share]| *share).collect();
    turning.retain(|share| *share > IDLE);
    turning.sort_by(f64::total_cmp);
    let usual = turning.get(turning.len() / 2).copied().unwrap_or(1.0);
    let least = (CARRIES * usual).max(IDLE);
    mean.map(|[share]| [f64::from(u8::from(share > least))])
}

/// Where a state that is held between its samples is 1, within the log.
pub(super) fn spans(states: &Track<1>, whole: Span) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since = None;
    for (time, [state]) in states.iter() {
        match (since, state >= 0.5) {
            (None, true) => since = Some(time),
            (Some(from_ns), false) => {
                spans.push(Span {
                    from_ns,
                    to_ns: time,
                });
                since = None;
            }
            _ => {}
        }
    }
    spans.extend(since.map(|from_ns| Span {
        from_ns,
        to_ns: whole.to_ns,
    }));
    spans
        .into_iter()
        .filter_map(|span| span.and(whole))
        .collect()
}

/// What of some spans is within others.
fn within(spans: &[Span], others: &[Span]) -> Vec<Span> {
    let both = |span: &Span| {
        others
            .iter()
            .filter_map(|other| span.and(*other))
            .collect::<Vec<_>>()
    };
    spans.iter().flat_map(both).collect()
}

/// Spans with what is short between them.
fn joined(spans: &[Span]) -> Vec<Span> {
    let mut joined: Vec<Span> = Vec::new();
    for &span in spans {
        match joined.last_mut() {
            Some(last) if span.from_ns - last.to_ns < BRIDGED_NS => last.to_ns = span.to_ns,
            _ => joined.push(span),
        }
    }
    joined
}

/// The part of a recording that is asked for.
///
/// # Errors
/// A number that no airborne part has, a span outside the log.
pub(super) fn choose(recording: &Recording, flown: &Flown, part: Part) -> Result<Taken, Fault> {
    let whole = recording
        .span()
        .ok_or_else(|| Fault::whole("has no gyroscope samples"))?;
    let asked = |span| Taken {
        span,
        reason: PartReason::AsAskedFor,
    };
    match part {
        Part::Longest => Ok(match (flown.longest(), flown.evidence) {
            (Some(span), _) => Taken {
                span,
                reason: PartReason::LongestAirborne,
            },
            (None, Evidence::Nothing) => Taken {
                span: whole,
                reason: PartReason::NothingShowsFlight,
            },
            (None, _) => Taken {
                span: whole,
                reason: PartReason::NeverAirborne,
            },
        }),
        Part::Number(number) => {
            let found = number
                .checked_sub(1)
                .and_then(|index| flown.parts.get(index));
            found.copied().map(asked).ok_or_else(|| {
                let count = flown.parts.len();
                Fault::whole(format!(
                    "--flight {number}: it holds {count} flights, `cargo hil info` lists them; \
                     --from and --to take any part"
                ))
            })
        }
        Part::Between(from_s, to_s) => between(whole, from_s, to_s).map(asked),
    }
}

/// A span of the log by its ends.
fn between(whole: Span, from_s: Option<f64>, to_s: Option<f64>) -> Result<Span, Fault> {
    let at = |s: f64| (s * SECOND_NS as f64) as i64;
    let asked = Span {
        from_ns: from_s.map_or(whole.from_ns, at),
        to_ns: to_s.map_or(whole.to_ns, at),
    };
    asked.and(whole).ok_or_else(|| {
        let (from, to) = (seconds(asked.from_ns), seconds(asked.to_ns));
        Fault::whole(format!(
            "--from {from} --to {to}: nothing is between them, it holds {whole}"
        ))
    })
}
