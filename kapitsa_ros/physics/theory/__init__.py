"""What theory says of the pendulum, from the averaged equation up to the nonlinear map."""
