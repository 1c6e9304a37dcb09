//! What every command is: a question, with parameters, an answer and a figure.

use crate::answer::Answer;
use crate::typed::Typed;
use anyhow::Result;
use std::any::Any;
use std::cell::RefCell;
use std::rc::Rc;
use turbid_figure::Figure;

/// The arguments of a command, which are all that it takes to answer.
pub trait Question {
    /// Gives the parameters as they were understood, and the values.
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()>;

    /// Draws what was asked.
    fn figure(&self, solved: &Solved) -> Result<Figure>;

    /// The parameters that rounding touches; estimates of densities, which have none, stand it well.
    fn typed(&self) -> Option<Typed> {
        None
    }

    /// The same question with another albedo, or other secondaries.
    fn moved(&self, _to: f64) -> Option<Box<dyn Question>> {
        None
    }
}

/// Answers all that is asked, or `wanted` alone, with bounds that hold for the decimals that were typed.
pub fn ask(question: &dyn Question, wanted: Option<&'static str>, solved: &Solved) -> Result<Answer> {
    let mut answer = Answer::new(wanted);
    question.answer(&mut answer, solved)?;
    if let Some(typed) = question.typed() {
        let quantities: Vec<_> = answer.rows.iter().map(|row| row.quantity).collect();
        let mut values: Vec<_> = answer.rows.iter_mut().map(|row| &mut row.value).collect();
        typed.widen(&mut values, |to| {
            let Some(moved) = question.moved(to) else { return Ok(None) };
            let mut nearby = Answer::new(wanted);
            moved.answer(&mut nearby, solved)?;
            let same = nearby.rows.iter().map(|row| row.quantity).eq(quantities);
            Ok(same.then(|| nearby.rows.iter().map(|row| row.value).collect()))
        })?;
    }
    answer.check()?;
    Ok(answer)
}

/// What has been solved so far, media, slabs, bodies, for the next question about the same.
#[derive(Default)]
pub struct Solved(RefCell<Vec<(String, Rc<dyn Any>)>>);

impl Solved {
    /// The most that is kept. A table asks by medium, so that what it asks again was solved not long ago.
    const MOST: usize = 256;

    /// What is solved of these parameters, now or earlier.
    pub fn once<T: Any>(&self, of: impl std::fmt::Debug, solve: impl FnOnce() -> Result<T>) -> Result<Rc<T>> {
        let of = format!("{of:?}");
        if let Some(found) = self.latest(|key, _: &T| key == of) {
            return Ok(found);
        }
        let new = Rc::new(solve()?);
        let mut kept = self.0.borrow_mut();
        if kept.len() >= Self::MOST {
            kept.clear();
        }
        kept.push((of, Rc::<T>::clone(&new)));
        Ok(new)
    }

    /// The last of its kind that suits.
    pub fn latest<T: Any>(&self, suits: impl Fn(&str, &T) -> bool) -> Option<Rc<T>> {
        let kept = self.0.borrow();
        let is_suited = |(of, found): &(String, Rc<dyn Any>)| {
            Rc::clone(found).downcast::<T>().ok().filter(|found| suits(of, found))
        };
        kept.iter().rev().find_map(is_suited)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_solved_is_not_solved_again() {
        let solved = Solved::default();
        assert_eq!(*solved.once((0.1, "a"), || Ok(1_u8)).unwrap(), 1);
        assert_eq!(*solved.once((0.1, "a"), || panic!("solved again")).map(|n: Rc<u8>| n).unwrap(), 1);
        // Other parameters, and another kind of the same.
        assert_eq!(*solved.once((0.1, "b"), || Ok(2_u8)).unwrap(), 2);
        assert_eq!(*solved.once((0.1, "a"), || Ok(3_u16)).unwrap(), 3);
        assert_eq!(solved.latest(|_, n: &u8| *n < 9).as_deref(), Some(&2));
        for n in 0..1000_u32 {
            solved.once(n, || Ok(n)).unwrap();
        }
        assert!(solved.0.borrow().len() <= Solved::MOST);
    }
}
