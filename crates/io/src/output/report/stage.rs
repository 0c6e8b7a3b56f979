//! The top of the page: the network in space with its clock, the verdict, the graph at that instant, and what is to vanish.

use maud::{Markup, html};

use super::super::metrics::{Absence, Gap, Metrics};
use super::super::record::RunRecord;
use super::{card, header, positions};

/// How fast time may pass, by its share of real time.
const RATES: [(&str, &str); 6] = [("0.1", "⅒"), ("0.5", "½"), ("1", "1"), ("2", "2"), ("5", "5"), ("20", "20")];

/// How long a film may last.
const FILMS_S: [u32; 4] = [5, 10, 20, 40];

/// A page for a talk, and what can be saved of it.
fn slide() -> Markup {
    html! {
        dialog #talk aria-label="A page for a talk" {
            canvas #talk-slide tabindex="0" role="img" aria-label="Title, verdict, the picture in space and one plot, at the time of the clock" {}
            div.talk-tools {
                label { "plot " select #talk-plot {} }
                button #talk-play type="button" autofocus { "Play" }
                button #talk-full type="button" { "Full screen" }
                button #talk-png type="button" { "PNG" }
                button #talk-svg type="button" { "SVG" }
                span {
                    label { "the run in " select #talk-seconds { @for s in FILMS_S { option value=(s) selected[s == 10] { (s) " s" } } } }
                    " "
                    label { "as " select #talk-means { option value="film" { "a film" } option value="frames" { "PNG frames" } } }
                    " "
                    button #talk-take type="button" { "Save" }
                }
                output #talk-progress {}
                button #talk-close type="button" { "Close" }
            }
        }
    }
}

/// How fast time passes, to be chosen.
pub(super) fn rates() -> Markup {
    html! { select #rate { @for (value, words) in RATES { option value=(value) selected[value == "1"] { (words) " ×" } } } }
}

/// Space and clock on one side; verdict, plot and graph on the other. The script fills what is empty.
pub(super) fn stage(record: &RunRecord<'_>, metrics: &Metrics, absence: Option<Absence>, goes_on: bool) -> Markup {
    let gap = Gap::of(record.setup);
    html! {
        section #stage aria-label="The network in space and time" data-goes-on=(goes_on) {
            div.card.space {
                div #view tabindex="0" role="application" aria-roledescription="picture in space" aria-describedby="view-help" {
                    div.corner {
                        label { input #follow type="checkbox" checked; " follow" }
                        button #view-reset type="button" { "Reset view" }
                        button #view-slide type="button" aria-haspopup="dialog" { "Slide" }
                        button #view-svg type="button" aria-label="Save the picture as a drawing" { "SVG" }
                    }
                }
                div.clock {
                    button #play type="button" aria-pressed="false" { "Play" }
                    input #slider type="range" min="0" max="1000" value="0" step="any" aria-label="Simulated time" aria-describedby="view-help";
                    output #time for="slider" { "t = 0 s" }
                    label { "rate " (rates()) }
                    label #choice { "agent " select #chosen { option value="" { "all" } } }
                }
                details { summary { "Keys and gestures" } p.note #view-help {
                    "Space plays and pauses; ← and → move in time, with Shift faster; Home and End go to the start and the end. "
                    "Drag or W, A, S, D turn the picture, the wheel with Ctrl, two fingers, + and − zoom. Plots follow the same clock: \
                     point at one to go to that time."
                } }
                noscript { p.note { "The picture needs JavaScript." } }
            }
            (slide())
            div.beside-space {
                div.card.verdict {
                    (header::promised(record))
                    (header::figures(record, metrics))
                }
                @if absence == Some(Absence::FewerThanTwoAgents) { (positions(record.setup)) }
                @else { (card("disagreement", gap.name(), gap.formula(record.setup), absence.map_or("", Absence::words))) }
                div.card #graph-now {
                    div.head { h3 { "Who hears whom" " " span.by #graph-when {} } }
                    div #graph-picture {}
                    p.note #graph-words {}
                }
            }
        }
    }
}
