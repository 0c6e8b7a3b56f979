//! Weighted digraphs in which an edge says who hears whom.

/// "`to` hears `from` with weight w": the entry w_ij of the adjacency matrix with i = `to`, j = `from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The sender j.
    pub from: usize,
    /// The receiver i.
    pub to: usize,
    /// w_ij > 0.
    pub weight: f64,
    /// Index into [`crate::network::Network::delays`].
    pub delay: usize,
}
