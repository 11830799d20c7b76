"""What `import kapitsa_ros` offers, one call a file; each command is a skin over one of them."""
