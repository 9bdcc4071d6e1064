//! Pages of HTML: one file, without scripts, for a screen and for paper.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// How a page looks.
const STYLE: &str = "
body { font: 16px/1.5 sans-serif; color: #222; margin: 2em auto; max-width: 1500px; padding: 0 1em }
p, ul { max-width: 60em }
table { border-collapse: collapse; font-size: 14px; display: block; overflow-x: auto }
th, td { padding: 2px 8px; text-align: right; white-space: nowrap; border-bottom: 1px solid #ddd }
th { vertical-align: bottom; border-bottom: 2px solid #222 }
th.name, td.name { text-align: left }
td.better { color: #006b4f } td.worse { color: #b03a00 }
figure { margin: 2em 0 } figcaption { max-width: 60em }
svg { max-width: 100%; height: auto }
.paper { border-left: 4px solid #bbb; padding-left: 1em }
.warning { border-left: 4px solid #b03a00; padding-left: 1em }
@media print { figure { break-inside: avoid } }
";

/// A page of this title. The template escapes all text.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    };
    page.into_string() + "\n"
}
