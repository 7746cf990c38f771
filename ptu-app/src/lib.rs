//! ptu-app
