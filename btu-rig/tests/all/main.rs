mod procedure_loader;
mod procedure_runner;
mod tcms_exhaustive;
mod tcms_figures;
mod tcms_system;
