"""The sensor behind Avalon interfaces, for Platform Designer and whoever else speaks them."""
