//! ato-under-test
