"""`mavhelm mcp`: the tools of an agent, over the Model Context Protocol.

To add or change:
- a tool: its row in `groundstation/verbs/agents/tools.py`. What changes something is a proposal.
- what the protocol itself does with a client: `groundstation/verbs/agents/server.py`.
"""
