//! btu-rig
