"""The sensor packaged for tools: Platform Designer, FuseSoC and whoever reads IP-XACT. See ``python -m build.ip``."""
