//! Environments with goals.

use crate::value::{Error, Result};

/// A task whose reward is a function of the goal that was achieved and the one that is desired:
/// Gymnasium-Robotics' `GoalEnv`.
///
/// The observation is a dict of `observation`, `achieved_goal` and `desired_goal`. The reward and
/// the flags of a step are those of the two goals that the step observes, so a learner can ask what
/// a step would have been worth for another goal (hindsight experience replay).
/// [`EnvExt::goals`](crate::EnvExt::goals) finds the task within any wrappers:
///
/// ```no_run
/// use gym_core::{EnvExt, make};
///
/// # fn main() -> gym_core::Result<()> {
/// let env = make("PointMaze_UMaze-v3")?;
/// if let Some(goals) = env.goals() {
///     assert_eq!(goals.compute_reward(&[1.0, 1.0], &[1.0, 1.1]), 1.0);
///     let mut rewards = [0.0; 2];
///     goals.compute_rewards(&[1.0, 1.0, 0.0, 0.0], &[1.0, 1.1, 1.0, 1.1], &mut rewards)?;
///     assert_eq!(rewards, [1.0, 0.0]);
/// }
/// # Ok(())
/// # }
/// ```
///
/// A goal is given as its numbers. Gymnasium-Robotics' `info`, on which no reward depends, is left
/// out.
pub trait Goals {
    /// The number of numbers of a goal.
    fn goal_len(&self) -> usize;

    /// The reward of a step that achieved one goal while another was desired.
    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64;

    /// Whether such a step terminates the episode.
    fn compute_terminated(&self, achieved: &[f64], desired: &[f64]) -> bool {
        let _ = (achieved, desired);
        false
    }

    /// Whether such a step truncates the episode, apart from limits of time.
    fn compute_truncated(&self, achieved: &[f64], desired: &[f64]) -> bool {
        let _ = (achieved, desired);
        false
    }

    /// The rewards of many steps, whose goals lie one after the other.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless both columns have [`goal_len`](Self::goal_len) numbers for
    /// each reward.
    fn compute_rewards(
        &self,
        achieved: &[f64],
        desired: &[f64],
        rewards: &mut [f64],
    ) -> Result<()> {
        let (length, count) = (self.goal_len(), rewards.len());
        for (name, goals) in [("achieved_goal", achieved), ("desired_goal", desired)] {
            if Some(goals.len()) != count.checked_mul(length) {
                let reason = format!(
                    "{} numbers for {count} rewards: a goal has {length}",
                    goals.len()
                );
                return Err(Error::argument(name, reason));
            }
        }
        let goals = achieved.chunks_exact(length.max(1));
        let pairs = goals.zip(desired.chunks_exact(length.max(1)));
        for (row, (reward, (achieved, desired))) in rewards.iter_mut().zip(pairs).enumerate() {
            *reward = self.compute_reward_in(row, count, achieved, desired);
        }
        Ok(())
    }

    /// The reward of a row of such columns, for a task that computes it otherwise than that of one
    /// step.
    fn compute_reward_in(&self, row: usize, rows: usize, achieved: &[f64], desired: &[f64]) -> f64 {
        let _ = (row, rows);
        self.compute_reward(achieved, desired)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Near;

    impl Goals for Near {
        fn goal_len(&self) -> usize {
            2
        }

        fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
            f64::from(achieved == desired)
        }
    }

    #[test]
    fn columns_have_a_goal_for_each_reward() {
        let (achieved, desired) = ([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 5.0]);
        let mut rewards = [7.0; 2];
        Near.compute_rewards(&achieved, &desired, &mut rewards)
            .unwrap();
        assert_eq!(rewards, [1.0, 0.0]);
        let error = Near.compute_rewards(&achieved, &desired[..3], &mut rewards);
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("desired_goal") && error.contains("3 numbers for 2"),
            "{error}"
        );
        assert!(!Near.compute_terminated(&achieved[..2], &desired[..2]));
    }
}
