//! Evaluates scripts and the libraries they load, within bounds.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashSet};

use starlark::PrintHandler;
use starlark::codemap::FileSpan;
use starlark::environment::{FrozenModule, Globals, Module};
use starlark::eval::{Evaluator, FileLoader};
use starlark::syntax::{AstModule, Dialect, DialectTypes};

use super::check::check;
use super::context::Context;
use super::draft::Declaration;
use super::error::{LoadError, cut};
use super::globals;
use super::handle::{Session, error};
use super::item::Item;
use super::nesting::too_deep;
use super::suggest::hint;

/// Function calls and loop rounds a script may use.
const MOST_TICKS: u64 = 500_000;
/// Memory a script may use, bytes.
const MOST_HEAP: usize = 64 << 20;
/// Depth of calls.
const DEEPEST_CALLS: usize = 50;
/// Longest script, bytes.
const LONGEST_SCRIPT: usize = 1 << 20;
/// Lines of `print` that are kept.
const MOST_PRINTED: usize = 1000;

type Declared = Vec<(Declaration, Vec<FileSpan>)>;

/// Evaluates the scripts of one folder; each library once.
pub(super) struct Evaluation<'a> {
    scripts: &'a BTreeMap<String, String>,
    context: &'a Context,
    predeclared: BTreeMap<&'static str, Item>,
    globals: Globals,
    /// Names of all globals.
    names: HashSet<String>,
    /// Called with the path of each script whose evaluation begins or goes on.
    evaluates: &'a dyn Fn(&str),
    libraries: RefCell<BTreeMap<String, Result<FrozenModule, ()>>>,
    /// Libraries being loaded, to find circles.
    loading: RefCell<Vec<String>>,
    library_errors: RefCell<Vec<LoadError>>,
    printed: RefCell<Vec<String>>,
    printing_stopped: Cell<bool>,
}

impl<'a> Evaluation<'a> {
    pub(super) fn new(
        scripts: &'a BTreeMap<String, String>,
        context: &'a Context,
        evaluates: &'a dyn Fn(&str),
    ) -> Self {
        let predeclared = globals::predeclared(context);
        let globals = globals::build(&predeclared);
        Self {
            scripts,
            context,
            predeclared,
            names: globals::names(&globals),
            globals,
            evaluates,
            libraries: RefCell::default(),
            loading: RefCell::default(),
            library_errors: RefCell::default(),
            printed: RefCell::default(),
            printing_stopped: Cell::default(),
        }
    }

    /// Errors of libraries and lines printed, at the end.
    pub(super) fn finish(self) -> (Vec<LoadError>, Vec<String>) {
        (self.library_errors.into_inner(), self.printed.into_inner())
    }

    /// Declarations of the script at `path`.
    pub(super) fn procedure(&self, path: &str, text: &str) -> Result<Declared, Vec<LoadError>> {
        self.evaluate(path, text, false)
            .map(|(_, declared)| declared)
    }

    /// Loads a library so that its errors are found even if nothing uses it.
    pub(super) fn library(&self, path: &str) -> Result<FrozenModule, ()> {
        if let Some(done) = self.libraries.borrow().get(path) {
            return done.clone();
        }
        let text = self.scripts.get(path).ok_or(())?;
        self.loading.borrow_mut().push(path.to_owned());
        let result = self.evaluate(path, text, true);
        self.loading.borrow_mut().pop();
        let module = result.map(|(module, _)| module).map_err(|errors| {
            self.library_errors.borrow_mut().extend(errors);
        });
        self.libraries
            .borrow_mut()
            .insert(path.to_owned(), module.clone());
        module
    }

    fn evaluate(
        &self,
        path: &str,
        text: &str,
        library: bool,
    ) -> Result<(FrozenModule, Declared), Vec<LoadError>> {
        (self.evaluates)(path);
        let ast = parse(path, text).map_err(|e| vec![e])?;
        let errors = check(&ast, self.context, &self.predeclared, &self.names);
        if !errors.is_empty() {
            return Err(errors);
        }
        let session = Session {
            context: self.context,
            is_library: library,
            declared: RefCell::default(),
        };
        let loader = Loader {
            evaluation: self,
            from: path,
        };
        let module = Module::with_temp_heap(|module| {
            {
                let mut eval = Evaluator::new(&module);
                eval.extra = Some(&session);
                eval.set_loader(&loader);
                eval.set_print_handler(self);
                eval.set_max_tick_count(MOST_TICKS).map_err(plain)?;
                eval.set_max_heap_size(MOST_HEAP).map_err(plain)?;
                eval.set_max_callstack_size(DEEPEST_CALLS).map_err(plain)?;
                eval.eval_module(ast, &self.globals)?;
            }
            Ok(module.freeze()?)
        })
        .map_err(|e| vec![LoadError::of_starlark(path, &e)])?;
        Ok((module, session.declared.into_inner()))
    }
}

fn plain(e: impl std::fmt::Display) -> starlark::Error {
    error(e.to_string())
}

fn parse(path: &str, text: &str) -> Result<AstModule, LoadError> {
    let dialect = Dialect {
        enable_keyword_only_arguments: true,
        enable_types: DialectTypes::Disable,
        enable_top_level_stmt: true,
        enable_f_strings: true,
        ..Dialect::Standard
    };
    if text.len() > LONGEST_SCRIPT {
        let message = format!("longer than {LONGEST_SCRIPT} bytes");
        return Err(LoadError::at_top(path, &message));
    }
    if let Some((line, column)) = too_deep(text) {
        return Err(LoadError::new(path, line, column, "nested too deeply"));
    }
    AstModule::parse(path, text.to_owned(), &dialect).map_err(|e| LoadError::of_starlark(path, &e))
}

impl PrintHandler for Evaluation<'_> {
    fn println(&self, text: &str) -> starlark::Result<()> {
        let mut printed = self.printed.borrow_mut();
        if printed.len() < MOST_PRINTED {
            printed.push(cut(text));
        } else if !self.printing_stopped.replace(true) {
            printed.push("… more was printed".into());
        }
        Ok(())
    }
}

/// Whether the script of this path is a library for `load()` and no procedure.
pub fn is_library(path: &str) -> bool {
    path.rsplit('/')
        .next()
        .is_some_and(|name| name.starts_with('_'))
}

/// Resolves `load()` for one script.
struct Loader<'a> {
    evaluation: &'a Evaluation<'a>,
    from: &'a str,
}

impl FileLoader for Loader<'_> {
    fn load(&self, wanted: &str) -> starlark::Result<FrozenModule> {
        let path = resolve(self.from, wanted).map_err(error)?;
        let evaluation = self.evaluation;
        if !evaluation.scripts.contains_key(&path) {
            let libraries = evaluation.scripts.keys().filter(|path| is_library(path));
            let hint = hint(&path, libraries.map(String::as_str));
            return Err(error(format!("no file `{path}` to load{hint}")));
        }
        if evaluation.loading.borrow().contains(&path) {
            return Err(error(format!("`{path}` loads itself in a circle")));
        }
        let library = evaluation.library(&path);
        (evaluation.evaluates)(self.from);
        library.map_err(|()| error(format!("`{path}` has errors of its own")))
    }
}

/// The path under the scripts folder that `wanted` means in the script `from`: `//x` from the
/// folder itself, anything else from the script's own folder.
fn resolve(from: &str, wanted: &str) -> Result<String, String> {
    let (mut parts, rest): (Vec<&str>, &str) = match wanted.strip_prefix("//") {
        Some(rest) => (Vec::new(), rest),
        None => {
            let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
            (
                folder.split('/').filter(|p| !p.is_empty()).collect(),
                wanted,
            )
        }
    };
    for part in rest.split('/') {
        match part {
            "." => {}
            ".." if parts.pop().is_none() => {
                return Err(format!("`{wanted}` is outside the scripts folder"));
            }
            ".." => {}
            "" => return Err(format!("`{wanted}` is not a path in the scripts folder")),
            part => parts.push(part),
        }
    }
    let path = parts.join("/");
    if is_library(&path) {
        Ok(path)
    } else {
        Err(format!(
            "`{wanted}` is no library: only files whose names start with _ can be loaded"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::resolve;

    #[test]
    fn loads_stay_inside_the_scripts_folder() {
        let cases = [
            ("atp/x.star", "//_lib.star", Ok("_lib.star")),
            ("atp/x.star", "_lib.star", Ok("atp/_lib.star")),
            ("atp/x.star", "../_lib.star", Ok("_lib.star")),
            ("atp/x.star", "./sub/_lib.star", Ok("atp/sub/_lib.star")),
            ("x.star", "../_lib.star", Err("outside")),
            ("x.star", "//../_lib.star", Err("outside")),
            ("x.star", "/etc/_passwd", Err("not a path")),
            ("x.star", "//other.star", Err("no library")),
        ];
        for (from, wanted, expected) in cases {
            match (resolve(from, wanted), expected) {
                (Ok(path), Ok(expected)) => assert_eq!(path, expected),
                (Err(message), Err(part)) => assert!(message.contains(part), "{message}"),
                (got, _) => panic!("{from} {wanted}: {got:?}"),
            }
        }
    }
}
