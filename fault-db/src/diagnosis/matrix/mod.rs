//! Dependency matrices: states with probabilities, tests with costs, and what each test says of each
//! state.
