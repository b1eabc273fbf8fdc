//! Vector fields that a test declares in one line.

/// Declares a vector field by its names and its right-hand side.
macro_rules! field {
    ($name:ident, [$($state:literal),*], [$($parameter:literal),*], |$x:ident, $p:ident, $d:ident| $body:block) => {
        struct $name;
        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                vec![$($state.into()),*]
            }
            fn parameter_names(&self) -> Vec<String> {
                vec![$($parameter.into()),*]
            }
            fn evaluate<T: Scalar>(&self, $x: &[T], $p: &[T], $d: &mut [T]) $body
        }
    };
}
