//! The algebra of graphs: expressions as one graph in which nothing stands twice, and its derivatives.
//!
//! Nodes are numbered in the order in which they were made, operands before results. Derivatives are made by the rules of
//! the calculus, node by node in that order, and kept.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

use super::float::{apply, combine, power};
use super::{Algebra, Binary, Expression, ExpressionError, MOST_NODES, Number, Unary};

/// A value in a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node(pub(super) usize);

/// How a node is computed. Constants stand as their bits, so that operations can be told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Op {
    Number(u64),
    Variable(usize),
    Unary(Unary, Node),
    Binary(Binary, Node, Node),
    Power(Node, u64),
}

impl Op {
    /// What it is computed from.
    fn operands(self) -> impl Iterator<Item = Node> {
        let operands = match self {
            Op::Number(_) | Op::Variable(_) => [None, None],
            Op::Unary(_, a) | Op::Power(a, _) => [Some(a), None],
            Op::Binary(_, a, b) => [Some(a), Some(b)],
        };
        operands.into_iter().flatten()
    }

    /// The same with operands that have other numbers.
    pub(super) fn moved(self, place: &[Node]) -> Self {
        match self {
            Op::Number(_) | Op::Variable(_) => self,
            Op::Unary(function, a) => Op::Unary(function, place[a.0]),
            Op::Power(a, exponent) => Op::Power(place[a.0], exponent),
            Op::Binary(function, a, b) => Op::Binary(function, place[a.0], place[b.0]),
        }
    }
}

/// A graph of operations on numbered variables.
#[derive(Clone, Debug)]
pub struct Graph {
    variables: usize,
    ops: Vec<Op>,
    known: BTreeMap<Op, Node>,
    /// Derivatives by variable, as far as they were asked for.
    slopes: BTreeMap<(usize, Node), Node>,
    full: bool,
}

impl Graph {
    /// An empty graph over `variables` variables.
    pub fn new(variables: usize) -> Self {
        let mut graph =
            Graph { variables, ops: Vec::new(), known: BTreeMap::new(), slopes: BTreeMap::new(), full: false };
        graph.number(0.0);
        graph
    }

    /// How many variables there are.
    pub fn variables(&self) -> usize {
        self.variables
    }

    pub(super) fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// Whether it has outgrown [`MOST_NODES`].
    pub(super) fn is_full(&self) -> bool {
        self.full
    }

    fn add_op(&mut self, op: Op) -> Node {
        if let Some(node) = self.known.get(&op) {
            return *node;
        }
        if self.ops.len() >= MOST_NODES {
            self.full = true;
            return Node(0);
        }
        let node = Node(self.ops.len());
        self.ops.push(op);
        self.known.insert(op, node);
        node
    }

    /// The value of a node that is a constant.
    pub(super) fn constant(&self, node: Node) -> Option<f64> {
        if let Op::Number(bits) = self.ops[node.0] { Some(f64::from_bits(bits)) } else { None }
    }

    /// A constant.
    pub fn number(&mut self, value: f64) -> Node {
        // One zero, whatever its sign.
        self.add_op(Op::Number((value + 0.0).to_bits()))
    }

    /// Zero.
    pub fn zero(&self) -> Node {
        Node(0)
    }

    /// Variable `index`.
    ///
    /// # Errors
    /// [`ExpressionError::Variable`] when there is none.
    pub fn variable(&mut self, index: usize) -> Result<Node, ExpressionError> {
        if index >= self.variables {
            return Err(ExpressionError::Variable { variable: index, count: self.variables });
        }
        Ok(self.add_op(Op::Variable(index)))
    }

    /// a to a constant power.
    pub fn power(&mut self, a: Node, exponent: f64) -> Node {
        match self.constant(a) {
            Some(value) => self.number(power(value, exponent)),
            None if exponent == 0.0 => self.number(1.0),
            None if exponent == 1.0 => a,
            None => self.add_op(Op::Power(a, exponent.to_bits())),
        }
    }

    /// a + b.
    pub fn plus(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Add, a, b)
    }

    /// a − b.
    pub fn minus(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Subtract, a, b)
    }

    /// a b.
    pub fn times(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Multiply, a, b)
    }

    /// a / b.
    pub fn over(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Divide, a, b)
    }

    /// c a for a constant c.
    pub fn scaled(&mut self, c: f64, a: Node) -> Node {
        let c = self.number(c);
        self.times(c, a)
    }

    /// Σ aᵢ bᵢ, as far as the shorter of the two goes.
    pub fn dot(&mut self, a: &[Node], b: &[Node]) -> Node {
        let mut sum = Node(0);
        for (a, b) in a.iter().zip(b) {
            let term = self.times(*a, *b);
            sum = self.plus(sum, term);
        }
        sum
    }

    /// The value of an expression.
    ///
    /// # Errors
    /// [`ExpressionError`] when it has a variable too many.
    pub fn import(&mut self, expression: &Expression) -> Result<Node, ExpressionError> {
        match expression.variables() {
            used if used > self.variables => {
                Err(ExpressionError::Variable { variable: used - 1, count: self.variables })
            }
            _ => Ok(expression.fold(self)),
        }
    }

    /// ∂ of a value by variable `by`.
    ///
    /// # Errors
    /// [`ExpressionError::NotSmooth`] when it holds |·|, min or max of something that varies, [`ExpressionError::Variable`]
    /// when there is no such variable.
    pub fn derivative(&mut self, of: Node, by: usize) -> Result<Node, ExpressionError> {
        if by >= self.variables {
            return Err(ExpressionError::Variable { variable: by, count: self.variables });
        }
        for node in self.below(&[of]) {
            if !self.slopes.contains_key(&(by, node)) {
                let slope = self.rule(node, by)?;
                self.slopes.insert((by, node), slope);
            }
        }
        Ok(self.slope(of, by))
    }

    /// A derivative that is known already.
    fn slope(&self, of: Node, by: usize) -> Node {
        self.slopes.get(&(by, of)).copied().unwrap_or(Node(0))
    }

    /// Values and all that they are made of, operands first.
    pub(super) fn below(&self, of: &[Node]) -> Vec<Node> {
        let last = of.iter().map(|node| node.0 + 1).max();
        let mut needed = vec![false; last.unwrap_or(0)];
        of.iter().for_each(|node| needed[node.0] = true);
        for index in (0..needed.len()).rev() {
            if needed[index] {
                self.ops[index].operands().for_each(|operand| needed[operand.0] = true);
            }
        }
        (0..needed.len()).filter(|index| needed[*index]).map(Node).collect()
    }

    /// The derivative of one operation, those of its operands being known.
    fn rule(&mut self, node: Node, by: usize) -> Result<Node, ExpressionError> {
        let jumps = |function| Err(ExpressionError::NotSmooth { function });
        match self.ops[node.0] {
            Op::Number(_) => Ok(Node(0)),
            Op::Variable(index) => Ok(self.number(if index == by { 1.0 } else { 0.0 })),
            Op::Unary(function, a) => {
                let da = self.slope(a, by);
                if da == Node(0) {
                    return Ok(da);
                }
                let outer = match function {
                    Unary::Negate => self.number(-1.0),
                    Unary::Sin => self.unary(Unary::Cos, a),
                    Unary::Cos => {
                        let sin = self.unary(Unary::Sin, a);
                        self.unary(Unary::Negate, sin)
                    }
                    Unary::Exp => node,
                    Unary::Log => self.power(a, -1.0),
                    Unary::Sqrt => {
                        let half = self.number(0.5);
                        self.over(half, node)
                    }
                    Unary::Tanh => {
                        let (one, square) = (self.number(1.0), self.power(node, 2.0));
                        self.minus(one, square)
                    }
                    Unary::Atan => {
                        let (one, square) = (self.number(1.0), self.power(a, 2.0));
                        let below = self.plus(one, square);
                        self.over(one, below)
                    }
                    Unary::Abs => return jumps("abs"),
                };
                Ok(self.times(outer, da))
            }
            Op::Power(a, bits) => {
                let exponent = f64::from_bits(bits);
                let da = self.slope(a, by);
                let below = self.power(a, exponent - 1.0);
                let outer = self.scaled(exponent, below);
                Ok(self.times(outer, da))
            }
            Op::Binary(function, a, b) => {
                let (da, db) = (self.slope(a, by), self.slope(b, by));
                match function {
                    Binary::Add | Binary::Subtract => Ok(self.binary(function, da, db)),
                    Binary::Multiply => Ok(self.dot(&[da, a], &[b, db])),
                    Binary::Divide => {
                        // (da − (a/b) db) / b
                        let turned = self.times(node, db);
                        let above = self.minus(da, turned);
                        Ok(self.over(above, b))
                    }
                    Binary::Min | Binary::Max if (da, db) == (Node(0), Node(0)) => Ok(da),
                    Binary::Min => jumps("min"),
                    Binary::Max => jumps("max"),
                }
            }
        }
    }
}

impl Algebra for Graph {
    type Value = Node;

    fn number(&mut self, number: &Number) -> Node {
        Graph::number(self, number.value())
    }
    fn variable(&mut self, index: usize) -> Node {
        self.add_op(Op::Variable(index))
    }
    fn unary(&mut self, function: Unary, a: Node) -> Node {
        match (self.constant(a), function, self.ops[a.0]) {
            (Some(value), ..) => self.number(apply(function, value)),
            (_, Unary::Negate, Op::Unary(Unary::Negate, inner)) => inner,
            _ => self.add_op(Op::Unary(function, a)),
        }
    }
    fn binary(&mut self, function: Binary, a: Node, b: Node) -> Node {
        let zero = Node(0);
        if let (Some(a), Some(b)) = (self.constant(a), self.constant(b)) {
            return self.number(combine(function, a, b));
        }
        let is = |graph: &Self, node: Node, value: f64| graph.constant(node) == Some(value);
        match function {
            Binary::Add if a == zero => b,
            Binary::Add | Binary::Subtract if b == zero => a,
            Binary::Subtract if a == zero => self.unary(Unary::Negate, b),
            Binary::Subtract if a == b => zero,
            Binary::Multiply if a == zero || b == zero => zero,
            Binary::Multiply if is(self, a, 1.0) => b,
            Binary::Multiply | Binary::Divide if is(self, b, 1.0) => a,
            Binary::Divide if a == zero => zero,
            // The order of operands does not matter to the bits of a sum or a product.
            Binary::Add | Binary::Multiply if b < a => self.add_op(Op::Binary(function, b, a)),
            _ => self.add_op(Op::Binary(function, a, b)),
        }
    }
    fn power(&mut self, a: Node, exponent: &Number) -> Node {
        Graph::power(self, a, exponent.value())
    }
}
