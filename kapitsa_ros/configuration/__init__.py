"""What is chosen by name or file: presets, instrument sets, protocols, tables; and the parameters of rig and steps."""
