//! Expressions as one graph in which nothing stands twice, and its derivatives.
//!
//! Nodes are numbered in the order in which they were made, operands before results. Derivatives are made by the rules of
//! the calculus, node by node in that order, and kept.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

use super::programme::{apply, combine, power};
use super::{Binary, Expression, ExpressionError, MOST_NODES, Step, Unary};

/// A value in a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node(pub(super) usize);

/// How a node is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Number(f64),
    Variable(usize),
    Unary(Unary, Node),
    Binary(Binary, Node, Node),
    Power(Node, f64),
}

/// What makes two operations the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Number(u64),
    Variable(usize),
    Unary(Unary, Node),
    Binary(Binary, Node, Node),
    Power(Node, u64),
}

/// A graph of operations on numbered variables.
#[derive(Clone, Debug)]
pub struct Graph {
    variables: usize,
    ops: Vec<Op>,
    known: BTreeMap<Key, Node>,
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
        let key = match op {
            Op::Number(value) => Key::Number(value.to_bits()),
            Op::Variable(index) => Key::Variable(index),
            Op::Unary(function, a) => Key::Unary(function, a),
            Op::Binary(function, a, b) => Key::Binary(function, a, b),
            Op::Power(a, exponent) => Key::Power(a, exponent.to_bits()),
        };
        if let Some(node) = self.known.get(&key) {
            return *node;
        }
        if self.ops.len() >= MOST_NODES {
            self.full = true;
            return Node(0);
        }
        let node = Node(self.ops.len());
        self.ops.push(op);
        self.known.insert(key, node);
        node
    }

    /// The value of a node that is a constant.
    fn constant(&self, node: Node) -> Option<f64> {
        if let Op::Number(value) = self.ops[node.0] { Some(value) } else { None }
    }

    /// A constant.
    pub fn number(&mut self, value: f64) -> Node {
        // One zero, whatever its sign.
        self.add_op(Op::Number(value + 0.0))
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

    /// A function of one value.
    pub fn unary(&mut self, function: Unary, a: Node) -> Node {
        match (self.constant(a), function, self.ops[a.0]) {
            (Some(value), ..) => self.number(apply(function, value)),
            (_, Unary::Negate, Op::Unary(Unary::Negate, inner)) => inner,
            _ => self.add_op(Op::Unary(function, a)),
        }
    }

    /// a to a constant power.
    pub fn power(&mut self, a: Node, exponent: f64) -> Node {
        match self.constant(a) {
            Some(value) => self.number(power(value, exponent)),
            None if exponent == 0.0 => self.number(1.0),
            None if exponent == 1.0 => a,
            None => self.add_op(Op::Power(a, exponent)),
        }
    }

    /// A function of two values.
    pub fn binary(&mut self, function: Binary, a: Node, b: Node) -> Node {
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
        let mut stack = Vec::new();
        for step in expression.steps() {
            let mut pop = || stack.pop().ok_or(ExpressionError::Unbalanced);
            let node = match *step {
                Step::Number(value) => self.number(value),
                Step::Variable(index) => self.variable(index)?,
                Step::Unary(function) => {
                    let a = pop()?;
                    self.unary(function, a)
                }
                Step::Power(exponent) => {
                    let a = pop()?;
                    self.power(a, exponent)
                }
                Step::Binary(function) => {
                    let (b, a) = (pop()?, pop()?);
                    self.binary(function, a, b)
                }
            };
            stack.push(node);
        }
        stack.pop().ok_or(ExpressionError::Unbalanced)
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
        for node in self.below(of) {
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

    /// A value and all that it is made of, operands first.
    fn below(&self, of: Node) -> Vec<Node> {
        let mut needed = vec![false; of.0 + 1];
        needed[of.0] = true;
        for index in (0..=of.0).rev() {
            if needed[index] {
                match self.ops[index] {
                    Op::Number(_) | Op::Variable(_) => {}
                    Op::Unary(_, a) | Op::Power(a, _) => needed[a.0] = true,
                    Op::Binary(_, a, b) => (needed[a.0], needed[b.0]) = (true, true),
                }
            }
        }
        (0..=of.0).filter(|index| needed[*index]).map(Node).collect()
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
            Op::Power(a, exponent) => {
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
