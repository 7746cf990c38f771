//! Checks a script without running it, branches that are never taken included.
//!
//! Walks the syntax tree and works out what is constant: names that are predeclared, literals,
//! calls of verbs. A call is bound by the same table that binds it when the script is run, so a
//! misspelt verb or parameter, a wrong type or unit, an unknown label or event are found wherever
//! they stand. What depends on variables is unknown here and is checked when the script runs.

use std::collections::{BTreeMap, HashSet};

use starlark::analysis::AstModuleLint;
use starlark::codemap::Span;
use starlark::syntax::AstModule;
use starlark::syntax::ast::{
    ArgumentP, AssignTarget, AstExpr, AstLiteral, AstNoPayload, AstParameterP, AstStmt, BinOp,
    CallArgsP, ClauseP, Expr, ForClause, Stmt,
};

use super::context::Context;
use super::error::LoadError;
use super::item::Item;
use super::suggest::{hint, near};

/// Expressions nested deeper than this, and blocks nested deeper than this, are refused: no person can read them, and walking
/// them would need an endless stack.
const DEEPEST: usize = 100;

/// Finds what is wrong with `ast` without running it.
pub(super) fn check(
    ast: &AstModule,
    context: &Context,
    predeclared: &BTreeMap<&'static str, Item>,
    names: &HashSet<String>,
) -> Vec<LoadError> {
    let mut checker = Checker {
        ast,
        context,
        predeclared,
        shadowed: HashSet::new(),
        depth: 0,
        too_deep: false,
        errors: Vec::new(),
    };
    let script = ast.statement();
    checker.collect_stmt(script);
    if !checker.too_deep {
        script.visit_expr(|expr| checker.collect_expr(expr));
    }
    if !checker.too_deep {
        script.visit_expr(|expr| _ = checker.expr(expr));
    }
    if checker.too_deep {
        return vec![LoadError::at(
            &ast.file_span(script.span),
            "nested too deeply",
        )];
    }
    let mut errors = checker.errors;
    errors.extend(undefined_names(ast, names));
    errors.sort_by_key(|e| (e.line, e.column));
    errors
}

/// Names that nothing defines, by Starlark's own analysis.
fn undefined_names(ast: &AstModule, names: &HashSet<String>) -> Vec<LoadError> {
    ast.lint(Some(names))
        .into_iter()
        .filter(|lint| lint.short_name == "using-undefined")
        .map(|lint| {
            let name = &lint.original;
            let hint = near(name, names.iter().map(String::as_str));
            LoadError::at(&lint.location, &format!("unknown name `{name}`{hint}"))
        })
        .collect()
}

struct Checker<'a> {
    ast: &'a AstModule,
    context: &'a Context,
    predeclared: &'a BTreeMap<&'static str, Item>,
    /// Names that the script itself binds anywhere: they may mean something else than the predeclared names.
    shadowed: HashSet<String>,
    depth: usize,
    too_deep: bool,
    errors: Vec<LoadError>,
}

impl Checker<'_> {
    fn deeper(&mut self, f: impl FnOnce(&mut Self)) {
        if self.depth >= DEEPEST {
            self.too_deep = true;
            return;
        }
        self.depth += 1;
        f(self);
        self.depth -= 1;
    }

    fn report(&mut self, span: Span, message: String) {
        let place = self.ast.file_span(span);
        self.errors.push(LoadError::at(&place, &message));
    }

    /// Notes all names that statements bind.
    fn collect_stmt(&mut self, stmt: &AstStmt) {
        self.deeper(|this| {
            match &stmt.node {
                Stmt::Assign(assign) => this.collect_target(&assign.lhs),
                Stmt::AssignModify(target, ..) => this.collect_target(target),
                Stmt::For(for_) => this.collect_target(&for_.var),
                Stmt::Def(def) => {
                    this.shadowed.insert(def.name.ident.clone());
                    this.collect_params(&def.params);
                }
                Stmt::Load(load) => {
                    let locals = load.args.iter().map(|arg| arg.local.ident.clone());
                    this.shadowed.extend(locals);
                }
                _ => {}
            }
            stmt.visit_stmt(|inner| this.collect_stmt(inner));
        });
    }

    fn collect_target(&mut self, target: &AssignTarget) {
        match target {
            AssignTarget::Identifier(name) => {
                self.shadowed.insert(name.ident.clone());
            }
            AssignTarget::Tuple(targets) => {
                self.deeper(|this| targets.iter().for_each(|t| this.collect_target(t)));
            }
            AssignTarget::Index(_) | AssignTarget::Dot(..) => {}
        }
    }

    fn collect_params(&mut self, params: &[AstParameterP<AstNoPayload>]) {
        let names = params.iter().filter_map(|param| param.ident());
        self.shadowed.extend(names.map(|name| name.ident.clone()));
    }

    /// Comprehensions and lambdas bind names inside expressions.
    fn collect_expr(&mut self, expr: &AstExpr) {
        self.deeper(|this| {
            match &expr.node {
                Expr::Lambda(lambda) => this.collect_params(&lambda.params),
                Expr::ListComprehension(_, first, rest)
                | Expr::DictComprehension(_, first, rest) => {
                    this.collect_target(&first.var);
                    for clause in rest {
                        if let ClauseP::For(for_) = clause {
                            this.collect_target(&for_.var);
                        }
                    }
                }
                _ => {}
            }
            expr.node.visit_expr(|inner| this.collect_expr(inner));
        });
    }

    /// Item of an expression, as far as it is known without running the script.
    fn expr(&mut self, expr: &AstExpr) -> Item {
        let mut found = Item::Unknown;
        self.deeper(|this| found = this.expr_here(expr));
        found
    }

    fn expr_here(&mut self, expr: &AstExpr) -> Item {
        match &expr.node {
            Expr::Literal(AstLiteral::String(text)) => Item::Text(text.node.clone()),
            Expr::Literal(AstLiteral::Float(n)) => Item::Float(n.node),
            Expr::Literal(AstLiteral::Int(n)) => {
                n.node.to_string().parse().map_or(Item::Unknown, Item::Int)
            }
            Expr::Identifier(name) => self.name(&name.node.ident),
            Expr::List(items) | Expr::Tuple(items) => {
                Item::List(items.iter().map(|item| self.expr(item)).collect())
            }
            Expr::Dot(of, name) => self.dot(of, &name.node, name.span),
            Expr::Call(verb, args) => self.call(expr.span, verb, args),
            Expr::Op(left, op, right) => self.operation(expr.span, left, *op, right),
            Expr::Minus(inner) => match self.expr(inner) {
                Item::Int(n) => n.checked_neg().map_or(Item::Unknown, Item::Int),
                Item::Float(n) => Item::Float(-n),
                Item::Quantity(q) => Item::Quantity(q.times(-1.0)),
                _ => Item::Unknown,
            },
            Expr::ListComprehension(value, first, rest) => {
                self.clauses(first, rest);
                self.expr(value);
                Item::Unknown
            }
            other => {
                other.visit_expr(|inner| {
                    self.expr(inner);
                });
                Item::Unknown
            }
        }
    }

    fn clauses(&mut self, first: &ForClause, rest: &[ClauseP<AstNoPayload>]) {
        self.expr(&first.over);
        for clause in rest {
            match clause {
                ClauseP::For(for_) => self.expr(&for_.over),
                ClauseP::If(condition) => self.expr(condition),
            };
        }
    }

    fn name(&self, name: &str) -> Item {
        if self.shadowed.contains(name) {
            return Item::Unknown;
        }
        match name {
            "True" => Item::Bool(true),
            "False" => Item::Bool(false),
            "None" => Item::None,
            _ => self.predeclared.get(name).cloned().unwrap_or(Item::Unknown),
        }
    }

    fn dot(&mut self, of: &AstExpr, name: &str, span: Span) -> Item {
        let of = self.expr(of);
        if !matches!(of, Item::Namespace(_) | Item::Record(_)) {
            return Item::Unknown;
        }
        of.attribute(name).unwrap_or_else(|| {
            let names = of.attributes();
            let hint = hint(name, names.iter().map(String::as_str));
            let owner = match &of {
                Item::Namespace(space) => (*space).to_owned(),
                other => other.found(),
            };
            self.report(span, format!("{owner} has no `{name}`{hint}"));
            Item::Unknown
        })
    }

    fn call(&mut self, span: Span, verb: &AstExpr, args: &CallArgsP<AstNoPayload>) -> Item {
        let verb_item = self.expr(verb);
        let (mut positional, mut named, mut spans) = (Vec::new(), Vec::new(), Vec::new());
        let mut open = false;
        for arg in &args.args {
            let value = self.expr(arg.node.expr());
            match &arg.node {
                ArgumentP::Positional(_) => positional.push(value),
                ArgumentP::Named(name, _) => named.push((name.node.clone(), value)),
                ArgumentP::Args(_) | ArgumentP::KwArgs(_) => {
                    open = true;
                    continue;
                }
            }
            spans.push(arg.span);
        }
        let Item::Verb(verb) = verb_item else {
            if !matches!(verb_item, Item::Unknown) {
                self.report(span, format!("{} cannot be called", verb_item.found()));
            }
            return Item::Unknown;
        };
        // With `*args` or `**kwargs` nothing can be said about what is missing.
        if open {
            return Item::Unknown;
        }
        match verb.call(self.context, positional, named) {
            Ok(item) => item,
            Err(error) => {
                let at = error.argument.and_then(|i| spans.get(i).copied());
                self.report(at.unwrap_or(span), error.message);
                Item::Unknown
            }
        }
    }

    fn operation(&mut self, span: Span, left: &AstExpr, op: BinOp, right: &AstExpr) -> Item {
        let (left, right) = (self.expr(left), self.expr(right));
        if let (Item::Signal(signal), BinOp::Equal | BinOp::NotEqual | BinOp::Less)
        | (Item::Signal(signal), BinOp::Greater | BinOp::LessOrEqual | BinOp::GreaterOrEqual) =
            (&left, op)
        {
            self.report(span, super::handle::no_value(signal.name()));
            return Item::Unknown;
        }
        let result = match op {
            BinOp::Add => left.plus(&right, 1.0),
            BinOp::Subtract => left.plus(&right, -1.0),
            BinOp::Multiply => left.times(&right),
            BinOp::Divide => left.over(&right),
            _ => None,
        };
        match result {
            Some(Ok(item)) => item,
            Some(Err(message)) => {
                self.report(span, message);
                Item::Unknown
            }
            None => Item::Unknown,
        }
    }
}
