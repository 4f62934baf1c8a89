"""What a user describes: structures, loads, dampers, materials, contact laws, cases."""
