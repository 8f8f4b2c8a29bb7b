//! The ride model's linearisation: mass and stiffness matrices, eigenfrequencies and mode shapes.
